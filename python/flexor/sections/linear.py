"""Lengths that follow the surface: a constant and a multiple of S."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from flexor.arrays import Array

# S at one place or at several.
Value = TypeVar("Value", float, Array)


@dataclass(frozen=True)
class Linear:
    """A length ``constant + multiple S``.

    Parameters
    ----------
    constant
        [m].
    multiple
        Of S.
    """

    constant: float
    multiple: float = 0.0

    def __add__(self, other: Linear) -> Linear:
        return Linear(self.constant + other.constant, self.multiple + other.multiple)

    def __sub__(self, other: Linear) -> Linear:
        return self + other * -1.0

    def __mul__(self, factor: float) -> Linear:
        return Linear(self.constant * factor, self.multiple * factor)

    def at(self, s: Value) -> Value:
        """Return the length where the surface is at S = `s` [m]."""
        return self.constant + self.multiple * s

    @property
    def coefficients(self) -> Array:
        """Coefficients of 1 and S; shape (2,)."""
        return np.array([self.constant, self.multiple])

    def times(self, other: Linear) -> Array:
        """Return the coefficients of 1, S and S² of a product; shape (3,)."""
        return np.convolve(self.coefficients, other.coefficients)


ZERO = Linear(0.0)
