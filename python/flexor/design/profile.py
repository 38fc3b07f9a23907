"""The interface of surface profiles S(X; p), and generic profiles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from flexor.arrays import Array


class Profile(Protocol):
    """A surface S(X; p) with X in [0, 1] (equations 10-12 of the paper are three of them)."""

    def value(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return S and dS/dX [m], each (n, m), of n designs ``p`` (n, k) at points ``X`` (m,)."""
        ...

    def jacobian(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return dS/dp and d(dS/dX)/dp, each (n, m, k)."""
        ...


@dataclass(frozen=True)
class Clamped:
    """A profile clamped to a minimum radius ("to prevent very small exosuit thickness").

    Where the profile is at or below the minimum, the radius is the minimum and the slope and all
    derivatives are exactly zero.
    """

    profile: Profile
    minimum: float

    def value(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return S and dS/dX [m], each (n, m)."""
        radius, slope = self.profile.value(p, X)
        clamped = radius <= self.minimum
        return np.where(clamped, self.minimum, radius), np.where(clamped, 0.0, slope)

    def jacobian(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return dS/dp and d(dS/dX)/dp, each (n, m, k); zero where the radius is clamped."""
        clamped = (self.profile.value(p, X)[0] <= self.minimum)[:, :, None]
        radius, slope = self.profile.jacobian(p, X)
        return np.where(clamped, 0.0, radius), np.where(clamped, 0.0, slope)


@dataclass(frozen=True)
class Fixed:
    """The linear taper (10) of a set without shape parameters."""

    radius_base: float
    radius_tip: float

    def value(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return S and dS/dX [m], each (n, m)."""
        taper = self.radius_tip - self.radius_base
        shape = (p.shape[0], X.size)
        return (
            np.broadcast_to(self.radius_base + X * taper, shape).copy(),
            np.full(shape, taper),
        )

    def jacobian(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return zeros, each (n, m, k)."""
        zero = np.zeros((p.shape[0], X.size, p.shape[1]))
        return zero, zero.copy()


@dataclass(frozen=True)
class Columns:
    """A profile that reads the columns ``first:last`` of a wider parameter array."""

    profile: Profile
    first: int
    last: int

    def value(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return S and dS/dX [m], each (n, m)."""
        return self.profile.value(p[:, self.first : self.last], X)

    def jacobian(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return dS/dp and d(dS/dX)/dp, each (n, m, k); zero in all other columns."""
        narrow = self.profile.jacobian(p[:, self.first : self.last], X)
        wide = []
        for part in narrow:
            full = np.zeros((*part.shape[:2], p.shape[1]))
            full[:, :, self.first : self.last] = part
            wide.append(full)
        return wide[0], wide[1]
