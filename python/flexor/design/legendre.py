"""Set RLP: the surface is a sum of Legendre polynomials (equation 12)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from flexor.model.geometry import FloatArray

CENTIMETRE = 0.01


@dataclass(frozen=True)
class Legendre:
    """S(X) = sum of A_{n+1} P_n(X), A_{n+1} = 2 a_n / 3^n in cm (12).

    Parameters are the dimensionless [a_0 ... a_{count-1}]. P_n is the ordinary Legendre polynomial
    read on X in [0, 1], not the polynomial shifted to that interval: so read, the published
    coefficients give the thin base and thick tip that the paper describes.
    """

    count: int = 10

    def value(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
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

    def jacobian(self, p: FloatArray, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return dS/dp and d(dS/dX)/dp, each (n, m, count); both are constant in p."""
        shape = (p.shape[0], X.size, self.count)
        radius_basis, slope_basis = self._basis(X)
        return (
            np.broadcast_to(radius_basis.T, shape).copy(),
            np.broadcast_to(slope_basis.T, shape).copy(),
        )

    def _basis(self, X: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the scaled P_n(X) and P_n'(X) [m], each (count, m)."""
        scale = CENTIMETRE * 2.0 / 3.0 ** np.arange(self.count)
        unit = np.eye(self.count)
        values = np.stack([legendre.legval(X, unit[n]) for n in range(self.count)])
        slopes = np.stack([legendre.legval(X, legendre.legder(unit[n])) for n in range(self.count)])
        return scale[:, None] * values, scale[:, None] * slopes
