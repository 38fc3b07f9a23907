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
        return product(self.coefficients, other.coefficients)


def at(coefficients: Array, s: Value) -> Array:
    """Return polynomials of S at S = `s`.

    Parameters
    ----------
    coefficients : (..., m) array
        Of 1, S, S² and so on.
    s : float or array
        S [m], of the shape of the polynomials if there are several.
    """
    found = coefficients[..., -1]
    for each in np.moveaxis(coefficients[..., -2::-1], -1, 0):
        found = each + found * s
    return np.asarray(found)


def product(polynomials: Array, lengths: Array) -> Array:
    """Return the coefficients of products of polynomials of S with lengths.

    Parameters
    ----------
    polynomials : (..., m) array
        Coefficients of 1, S, S² and so on.
    lengths : (..., 2) array
        Coefficients of 1 and S.

    Returns
    -------
    (..., m + 1) array
    """
    constant, multiple = polynomials * lengths[..., :1], polynomials * lengths[..., 1:]
    made = np.zeros((*constant.shape[:-1], constant.shape[-1] + 1))
    made[..., :-1] += constant
    made[..., 1:] += multiple
    return made


ZERO = Linear(0.0)
