"""What a surface profile S(X; p) must offer, and two ways to wrap one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from flexor.design.geometry import FloatArray


class Profile(Protocol):
    """A surface S(X; p) with X in [0, 1] (equations 10-12 of the paper are three of them)."""

    def value(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """S and dS/dX [m], each (n, m), of n designs ``p`` (n, k) at points ``X`` (m,)."""
        ...

    def jacobian(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """dS/dp and d(dS/dX)/dp, each (n, m, k)."""
        ...


@dataclass(frozen=True)
class Clamped:
    """A profile held at a minimum radius ("to prevent very small exosuit thickness").

    Where the profile is at or under the minimum, the radius is the minimum and both the slope and
    every derivative are exactly zero; elsewhere the profile is untouched.
    """

    profile: Profile
    minimum: float

    def value(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """S and dS/dX [m], each (n, m)."""
        radius, slope = self.profile.value(p, X)
        held = radius <= self.minimum
        return np.where(held, self.minimum, radius), np.where(held, 0.0, slope)

    def jacobian(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """dS/dp and d(dS/dX)/dp, each (n, m, k); zero where the minimum holds."""
        held = (self.profile.value(p, X)[0] <= self.minimum)[:, :, None]
        radius, slope = self.profile.jacobian(p, X)
        return np.where(held, 0.0, radius), np.where(held, 0.0, slope)


@dataclass(frozen=True)
class Fixed:
    """The profile of a set without shape parameters: straight from base to tip (10)."""

    radius_base: float
    radius_tip: float

    def value(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """S and dS/dX [m], each (n, m)."""
        taper = self.radius_tip - self.radius_base
        shape = (p.shape[0], X.size)
        return (
            np.broadcast_to(self.radius_base + X * taper, shape).copy(),
            np.full(shape, taper),
        )

    def jacobian(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Zero, (n, m, k): nothing depends on the parameters."""
        zero = np.zeros((p.shape[0], X.size, p.shape[1]))
        return zero, zero.copy()


@dataclass(frozen=True)
class Columns:
    """A profile that reads the columns ``first:last`` of a wider parameter array."""

    profile: Profile
    first: int
    last: int

    def value(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """S and dS/dX [m], each (n, m)."""
        return self.profile.value(p[:, self.first : self.last], X)

    def jacobian(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """dS/dp and d(dS/dX)/dp, each (n, m, k); zero in the columns of others."""
        narrow = self.profile.jacobian(p[:, self.first : self.last], X)
        wide = []
        for part in narrow:
            full = np.zeros((*part.shape[:2], p.shape[1]))
            full[:, :, self.first : self.last] = part
            wide.append(full)
        return wide[0], wide[1]
