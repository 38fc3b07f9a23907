"""Shapes in a cross-section, cut into cells by Gauss quadrature.

Sizes are linear in the surface S(X), so that cells are at places linear in S and have areas
quadratic in S: a shape is cut up once for every S.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import pi, sin

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.sections.across import FEWEST
from flexor.sections.linear import ZERO, Linear, Value, product

# Quadrature points: along the radius of a disc, over the height of a full arc and of half of one,
# and along a side. Polynomials of y and z are exact up to the fifth degree on a full arc, up to the
# third on half of one.
_RADII, _ARC, _HALF_ARC, _SIDE = 4, 3, 2, 4
# For moments, which are exact then.
_EXACT = 6


@dataclass(frozen=True, eq=False)
class Cells:
    """Parts of a shape, n of them.

    Attributes
    ----------
    y, z : (n, 2) arrays
        Their places: coefficients of 1 and S [m, 1].
    area : (n, 3) array
        Coefficients of 1, S and S² [m², m, 1].
    radius : (n, 2) array or None
        Distance from the centre of the arc that they are part of, as the places.
    """

    y: Array
    z: Array
    area: Array
    radius: Array | None = None


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
    across
        Points of the quadrature between the radii of a ring; see `flexor.sections.across`.
    """

    y: Linear
    z: Linear
    inner: Linear
    outer: Linear
    half: bool = False
    ratio: float = 1.0
    across: int = FEWEST

    def cells(self, folded: bool, exact: bool = False) -> Cells:
        """Cut the shape up.

        Parameters
        ----------
        folded
            Whether cells of equal z are to be one.
        exact
            Whether areas and moments have to be exact.
        """
        radii = _EXACT if exact else _RADII if self.inner == ZERO else self.across
        angles = _EXACT if exact else _HALF_ARC if self.half else _ARC
        cosine, sine, place, share = _polar_rule(self.half, folded, angles, radii)
        thickness = (self.outer - self.inner).coefficients
        radius = self.inner.coefficients + place * thickness
        y = np.broadcast_to(self.y.coefficients, radius.shape)
        return Cells(
            y if folded else y + radius * (cosine * self.ratio),
            self.z.coefficients + radius * sine,
            product(radius, thickness) * (share * self.ratio),
            radius,
        )

    def contains(self, y: Array, z: Array, s: float) -> NDArray[np.bool_]:
        """Whether points are inside, by more than rounding."""
        dy, dz = (y - self.y.at(s)) / self.ratio, z - self.z.at(s)
        margin, distance = 1e-9 * self.outer.at(s), np.hypot(dy, dz)
        inside = (self.inner.at(s) + margin < distance) & (distance < self.outer.at(s) - margin)
        return np.asarray(inside & (dz >= margin) if self.half else inside)

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

    def cells(self, folded: bool, exact: bool = False) -> Cells:
        """Cut the shape up; see `Sector.cells`."""
        across, up, share = _side_rule(folded, *((_EXACT, _EXACT) if exact else self.points))
        return Cells(
            self.y.coefficients + self.width.coefficients * across,
            self.z.coefficients + self.height.coefficients * up,
            self.width.times(self.height) * share,
        )

    def contains(self, y: Array, z: Array, s: float) -> NDArray[np.bool_]:
        """Whether points are inside, by more than rounding."""
        half = [0.5 * (1.0 - 1e-9) * side.at(s) for side in (self.width, self.height)]
        inside = (np.abs(y - self.y.at(s)) < half[0]) & (np.abs(z - self.z.at(s)) < half[1])
        return np.asarray(inside)

    def extent(self, s: Value) -> tuple[Value, Value, Value, Value]:
        """Return the lowest and highest y, and z [m]; of an array S, arrays."""
        y, z, b, h = (side.at(s) for side in (self.y, self.z, self.width, self.height))
        return y - 0.5 * b, y + 0.5 * b, z - 0.5 * h, z + 0.5 * h


Shape = Sector | Rectangle


@lru_cache(maxsize=64)
def _polar_rule(half: bool, folded: bool, angles: int, radii: int) -> Array:
    """Cosines and sines of angles from the y axis, places across a ring, and shares [rad].

    The four as (4, n, 1), along the radius first. Gauss rules for functions of the sine: with as
    many angles, polynomials up to the degree 2 angles - 1.
    """
    if half:
        sine, share = _arc(angles)
    else:
        sine = np.array([sin((k + 0.5) * pi / angles - pi / 2) for k in range(angles)])
        share = np.full(angles, pi / angles)
    cosine = np.sqrt(1.0 - sine * sine)
    if folded:
        share = 2.0 * share
    else:
        cosine, sine, share = np.append(cosine, -cosine), np.tile(sine, 2), np.tile(share, 2)
    place, weight = _gauss(radii)
    rule = [*np.repeat([cosine, sine], radii, axis=1), np.tile(place, len(sine))]
    return _fixed(*rule, np.repeat(share, radii) * np.tile(weight, len(sine)))


@lru_cache(maxsize=64)
def _side_rule(folded: bool, across: int, up: int) -> Array:
    """Places along both sides of a unit square from its middle, and shares, (3, n, 1)."""
    along, share = (np.array([0.5]), np.ones(1)) if folded else _gauss(across)
    height, weight = _gauss(up)
    rule = np.repeat(along - 0.5, up), np.tile(height - 0.5, len(along))
    return _fixed(*rule, np.repeat(share, up) * np.tile(weight, len(along)))


def _fixed(*columns: Array) -> Array:
    rule = np.stack(columns)[:, :, None]
    rule.setflags(write=False)
    return rule


def _gauss(points: int) -> tuple[Array, Array]:
    """Gauss-Legendre rule on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(points)
    return 0.5 * (x + 1.0), 0.5 * w


def _arc(points: int) -> tuple[Array, Array]:
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
    return nodes, pi / 2.0 * vectors[0] ** 2


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
    cells = [shape.cells(folded=False, exact=True) for shape in shapes]
    rows = [
        np.concatenate([c.area, product(c.area, c.y), product(c.area, c.z)], axis=1) for c in cells
    ]
    total: Array = np.concatenate([np.zeros((0, 11)), *rows]).sum(axis=0)
    total.setflags(write=False)
    return total
