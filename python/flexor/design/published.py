"""The published surfaces: linear, a sine and a cosine wave, Legendre polynomials (10)-(12)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre

from flexor.arrays import Array

CENTIMETRE = 0.01


@dataclass(frozen=True)
class Linear:
    """S(X) = R_0 + X (R_1 - R_0), parameters [R_0, R_1] in m (10).

    No minimum radius is applied here: the paper searches R_0 and R_1 down to 0.4 cm (Fig. 4, and
    "not at the lower bounds of the radii (0.4 cm)"), under the 0.5 cm it states for surfaces in
    general. A straight surface is nowhere thinner than its ends, so the bounds on the two radii
    already are its minimum; a clamp would flatten the strip 0.4-0.5 cm of that search.
    """

    def value(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return S and dS/dX [m], each (n, m)."""
        base, taper = p[:, :1], p[:, 1:] - p[:, :1]
        return base + X * taper, np.repeat(taper, X.size, axis=1)

    def jacobian(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return dS/dp and d(dS/dX)/dp, each (n, m, 2)."""
        shape = (p.shape[0], X.size, 2)
        radius = np.stack((1.0 - X, X), axis=1)
        return (
            np.broadcast_to(radius, shape).copy(),
            np.broadcast_to(np.array([-1.0, 1.0]), shape).copy(),
        )


@dataclass(frozen=True)
class SineCosine:
    """S(X) = R_0 + R_0/20 (sin(A pi X + phi_A) + cos(B pi X + phi_B)) (11).

    The parameters are [A, B, phi_A, phi_B] (frequencies in half waves per length, phases in rad).
    R_0, the base radius of the model's exosuit [m], is not a parameter (Table II).
    """

    radius_base: float

    def value(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return S and dS/dX [m], each (n, m)."""
        sine, cosine, amplitude = self._waves(p, X)
        radius = self.radius_base + amplitude * (np.sin(sine) + np.cos(cosine))
        slope = (amplitude * np.pi) * (p[:, 0:1] * np.cos(sine) - p[:, 1:2] * np.sin(cosine))
        return radius, slope

    def jacobian(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return dS/dp and d(dS/dX)/dp, each (n, m, 4)."""
        sine, cosine, amplitude = self._waves(p, X)
        A, B = p[:, 0:1], p[:, 1:2]
        sin_a, cos_a, sin_b, cos_b = np.sin(sine), np.cos(sine), np.sin(cosine), np.cos(cosine)
        radius = np.stack((np.pi * X * cos_a, -np.pi * X * sin_b, cos_a, -sin_b), axis=2)
        slope = np.stack(
            (
                cos_a - np.pi * X * A * sin_a,
                -sin_b - np.pi * X * B * cos_b,
                -A * sin_a,
                -B * cos_b,
            ),
            axis=2,
        )
        return amplitude * radius, (amplitude * np.pi) * slope

    def _waves(self, p: Array, X: Array) -> tuple[Array, Array, float]:
        sine = np.pi * p[:, 0:1] * X + p[:, 2:3]
        cosine = np.pi * p[:, 1:2] * X + p[:, 3:4]
        return sine, cosine, self.radius_base / 20.0


@dataclass(frozen=True)
class Legendre:
    """S(X) = sum of A_{n+1} P_n(X), A_{n+1} = 2 a_n / 3^n in cm (12).

    Parameters are the dimensionless [a_0 ... a_{count-1}]. P_n is the ordinary Legendre polynomial
    read on X in [0, 1], not the polynomial shifted to that interval: so read, the published
    coefficients give the thin base and thick tip that the paper describes.
    """

    count: int = 10

    def value(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return S and dS/dX [m], each (n, m)."""
        radius_basis, slope_basis = self._basis(X)
        radius = np.zeros((p.shape[0], X.size))
        slope = np.zeros_like(radius)
        # Added term by term: a matrix product may round differently with the size of the batch,
        # and a design must not depend on its neighbours.
        for n in range(self.count):
            radius += p[:, n : n + 1] * radius_basis[n]
            slope += p[:, n : n + 1] * slope_basis[n]
        return radius, slope

    def jacobian(self, p: Array, X: Array) -> tuple[Array, Array]:
        """Return dS/dp and d(dS/dX)/dp, each (n, m, count); both are constant in p."""
        shape = (p.shape[0], X.size, self.count)
        radius_basis, slope_basis = self._basis(X)
        return (
            np.broadcast_to(radius_basis.T, shape).copy(),
            np.broadcast_to(slope_basis.T, shape).copy(),
        )

    def _basis(self, X: Array) -> tuple[Array, Array]:
        """Return the scaled P_n(X) and P_n'(X) [m], each (count, m)."""
        return _legendre(self.count, np.asarray(X, dtype=np.float64).tobytes())


@lru_cache(maxsize=16)
def _legendre(count: int, points: bytes) -> tuple[Array, Array]:
    """Return what `Legendre` sums at points (m,) given by their bytes, each (count, m)."""
    X, unit = np.frombuffer(points), np.eye(count)
    scale = CENTIMETRE * 2.0 / 3.0 ** np.arange(count)
    values = np.stack([legendre.legval(X, unit[n]) for n in range(count)])
    slopes = np.stack([legendre.legval(X, legendre.legder(unit[n])) for n in range(count)])
    found = scale[:, None] * values, scale[:, None] * slopes
    for each in found:
        each.setflags(write=False)
    return found
