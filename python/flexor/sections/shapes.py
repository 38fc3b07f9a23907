"""Shapes in a cross-section, cut into cells by Gauss quadrature.

Sizes are linear in the surface S(X), so that cells are at places linear in S and have areas
quadratic in S: a shape is cut up once for every S.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, lru_cache
from math import pi, sin, sqrt

import numpy as np

from flexor.arrays import Array
from flexor.sections.linear import ZERO, Linear, Value

# Quadrature points: across a wall, along the radius of a disc, over the height of a full arc and of
# half of one, and along a side. Polynomials of y and z are exact up to the fifth degree on a full
# arc, up to the third on half of one.
_ACROSS, _RADII, _ARC, _HALF_ARC, _SIDE = 2, 4, 3, 2, 4
# For moments, which are exact then.
_EXACT = 6


@dataclass(frozen=True)
class Cell:
    """A part of a shape.

    Attributes
    ----------
    y, z : Linear
        Place [m].
    area : (3,) array
        Coefficients of 1, S and S² [m², m, 1].
    radius : Linear or None
        Distance from the centre of the arc that it is part of.
    """

    y: Linear
    z: Linear
    area: Array
    radius: Linear | None = None


@dataclass(frozen=True)
class Sector:
    """A sector of a ring: of a tube, a disc or the halves of these.

    Parameters
    ----------
    y, z
        Centre.
    inner, outer
        Radii.
    half
        Whether only the half above the centre.
    ratio
        Extent along y by that along z; not 1 for ellipses.
    """

    y: Linear
    z: Linear
    inner: Linear
    outer: Linear
    half: bool = False
    ratio: float = 1.0

    def cells(self, folded: bool, exact: bool = False) -> list[Cell]:
        """Cut the shape up.

        Parameters
        ----------
        folded
            Whether cells of equal z are to be one.
        exact
            Whether areas and moments have to be exact.
        """
        solid = self.inner == ZERO
        radial = _gauss(_EXACT if exact else _RADII if solid else _ACROSS)
        thickness = self.outer - self.inner
        found = []
        usual = _HALF_ARC if self.half else _ARC
        for cosine, sine, share in self._directions(folded, _EXACT if exact else usual):
            for place, weight in radial:
                r = self.inner + thickness * place
                area = r.times(thickness) * (share * weight * self.ratio)
                y = self.y if folded else self.y + r * (cosine * self.ratio)
                found.append(Cell(y, self.z + r * sine, area, r))
        return found

    def _directions(self, folded: bool, points: int) -> list[tuple[float, float, float]]:
        """Cosines and sines of angles from the y axis, with what they stand for [rad].

        Gauss rules for functions of the sine: with n points, polynomials up to the degree 2n - 1.
        """
        if self.half:
            rule = _arc(points)
        else:
            rule = [(sin((k + 0.5) * pi / points - pi / 2), pi / points) for k in range(points)]
        sides = [(sqrt(1.0 - sine * sine), sine, weight) for sine, weight in rule]
        if folded:
            return [(cosine, sine, 2.0 * weight) for cosine, sine, weight in sides]
        return [(sign * cosine, sine, w) for sign in (1.0, -1.0) for cosine, sine, w in sides]

    def contains(self, y: float, z: float, s: float) -> bool:
        """Whether a point is inside, by more than rounding."""
        dy, dz = (y - self.y.at(s)) / self.ratio, z - self.z.at(s)
        margin = 1e-9 * self.outer.at(s)
        if self.half and dz < margin:
            return False
        return self.inner.at(s) + margin < float(np.hypot(dy, dz)) < self.outer.at(s) - margin

    def extent(self, s: Value) -> tuple[Value, Value, Value, Value]:
        """Return the lowest and highest y, and z [m]; of an array S, arrays."""
        y, z, r = self.y.at(s), self.z.at(s), self.outer.at(s)
        return y - r * self.ratio, y + r * self.ratio, z if self.half else z - r, z + r


@dataclass(frozen=True)
class Rectangle:
    """A rectangle.

    Parameters
    ----------
    y, z
        Middle.
    width, height
        Along y and z.
    points
        Of the quadrature along y and z; across a thin wall two suffice.
    """

    y: Linear
    z: Linear
    width: Linear
    height: Linear
    points: tuple[int, int] = (_SIDE, _SIDE)

    def cells(self, folded: bool, exact: bool = False) -> list[Cell]:
        """Cut the shape up; see `Sector.cells`."""
        across_points, up_points = (_EXACT, _EXACT) if exact else self.points
        found = []
        for across, share in [(0.5, 1.0)] if folded else _gauss(across_points):
            for up, weight in _gauss(up_points):
                y = self.y + self.width * (across - 0.5)
                z = self.z + self.height * (up - 0.5)
                found.append(Cell(y, z, self.width.times(self.height) * (share * weight)))
        return found

    def contains(self, y: float, z: float, s: float) -> bool:
        """Whether a point is inside, by more than rounding."""
        half = [0.5 * (1.0 - 1e-9) * side.at(s) for side in (self.width, self.height)]
        return abs(y - self.y.at(s)) < half[0] and abs(z - self.z.at(s)) < half[1]

    def extent(self, s: Value) -> tuple[Value, Value, Value, Value]:
        """Return the lowest and highest y, and z [m]; of an array S, arrays."""
        y, z, b, h = (side.at(s) for side in (self.y, self.z, self.width, self.height))
        return y - 0.5 * b, y + 0.5 * b, z - 0.5 * h, z + 0.5 * h


Shape = Sector | Rectangle


@cache
def _gauss(points: int) -> list[tuple[float, float]]:
    """Gauss-Legendre rule on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(points)
    return [(0.5 * (a + 1.0), 0.5 * b) for a, b in zip(x.tolist(), w.tolist(), strict=True)]


@cache
def _arc(points: int) -> list[tuple[float, float]]:
    """Gauss rule for ∫ f(sin φ) dφ from 0 to π/2 (Golub and Welsch 1969)."""
    x, w = np.polynomial.legendre.leggauss(40)
    angle, weight = (x + 1.0) * pi / 4.0, w * pi / 4.0
    sine = np.sin(angle)
    diagonal, beside = np.zeros(points), np.zeros(points)
    before, here = np.zeros_like(sine), np.full_like(sine, 1.0 / np.sqrt(pi / 2.0))
    for k in range(points):
        diagonal[k] = weight @ (sine * here * here)
        after = (sine - diagonal[k]) * here - beside[k - 1] * before
        beside[k] = np.sqrt(weight @ (after * after))
        before, here = here, after / beside[k]
    matrix = np.diag(diagonal) + np.diag(beside[:-1], 1) + np.diag(beside[:-1], -1)
    nodes, vectors = np.linalg.eigh(matrix)
    weights = pi / 2.0 * vectors[0] ** 2
    return list(zip(nodes.tolist(), weights.tolist(), strict=True))


@lru_cache(maxsize=1024)
def moments(shapes: tuple[Shape, ...]) -> Array:
    """Return area and first moments as polynomials of S.

    Parameters
    ----------
    shapes
        Shapes that do not overlap.

    Returns
    -------
    (11,) array
        Coefficients of 1, S, S² of the area, then those of 1, S, S², S³ of ∫ y dA and ∫ z dA [SI].
    """
    total = np.zeros(11)
    for shape in shapes:
        for cell in shape.cells(folded=False, exact=True):
            total[:3] += cell.area
            total[3:7] += np.convolve(cell.area, cell.y.coefficients)
            total[7:] += np.convolve(cell.area, cell.z.coefficients)
    total.setflags(write=False)
    return total
