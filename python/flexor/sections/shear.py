"""Shear stiffness of a cross-section, from the shear stress that bending leaves in equilibrium.

A shear force Q bends the rod, and the part of the section beyond a line is held by the shear
stress along it, τ b = Q ∫ E (z - z_c) dA/EI; across the line, the stress follows the outline, which
is free (Timoshenko and Goodier 1970, chapter 12). The rod that stores the same energy has the
stiffness EI²/∫ (∫ E (z - z_c) dA)²/(G b) dz. In layers, stress passes through the softest: a stiff
sheet at the bottom hardly takes part.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from math import pi

import numpy as np

from flexor.arrays import Array
from flexor.sections.geometry import Part
from flexor.sections.shapes import Rectangle, Sector, Shape

_NODES = 24  # of the quadrature between two edges


def shear_stiffness(
    parts: Sequence[Part], axial: Mapping[str, float], shear: Mapping[str, float], s: float
) -> tuple[float, float]:
    """Return the stiffness of shear along y and along z [N].

    Parameters
    ----------
    parts
        Parts of material.
    axial
        Tangent modulus of the fibres of each material at rest [Pa].
    shear
        Shear modulus of each material [Pa].
    s
        The surface S [m].
    """
    real = [part for part in parts if not part.stiffening]
    along_y, along_z = (_along(axis, real, axial, shear, s) for axis in (0, 1))
    return along_y, along_z


def _along(
    axis: int,
    parts: Sequence[Part],
    axial: Mapping[str, float],
    shear: Mapping[str, float],
    s: float,
) -> float:
    place, weight, after = _rule()
    edges = np.unique([edge for part in parts for edge in _edges(part.shape, axis, s)])
    # Edges that differ by rounding only are one.
    edges = edges[np.diff(edges, prepend=-np.inf) > 1e-9 * (edges[-1] - edges[0])]
    half = 0.5 * np.diff(edges)[:, None]
    z = 0.5 * (edges[:-1] + edges[1:])[:, None] + half * place
    tension, flow, oblique = np.zeros((3, *z.shape))
    for part in parts:
        width, slope = _width(part.shape, axis, z, s)
        tension += axial[part.material] / part.stretch * width
        flow += shear[part.material] * width
        oblique += shear[part.material] * width * slope
    each = half * weight
    centre = (each * tension * z).sum() / (each * tension).sum()
    moment = tension * (z - centre)
    bending = (each * moment * (z - centre)).sum()
    sums = (each * moment).sum(axis=1)
    beyond = sums[::-1].cumsum()[::-1] - sums
    held = beyond[:, None] + half * (moment @ after)
    # Parts that do not touch are linked somewhere.
    flow[flow == 0.0] = np.inf
    return float(bending**2 / (each * held**2 * (1.0 + oblique / flow) / flow).sum())


def _edges(shape: Shape, axis: int, s: float) -> list[float]:
    """Where the width of a shape is not smooth, along y (0) or z (1)."""
    low_y, high_y, low_z, high_z = shape.extent(s)
    found = [[low_y, high_y], [low_z, high_z]][axis]
    if not isinstance(shape, Rectangle) and (inner := shape.inner.at(s)) > 0.0:
        middle, reach = [(shape.y.at(s), inner * shape.ratio), (shape.z.at(s), inner)][axis]
        found += [middle + reach] if axis == 1 and shape.half else [middle - reach, middle + reach]
    return found


def _width(shape: Shape, axis: int, z: Array, s: float) -> tuple[Array, Array]:
    """Return the width of a shape across y (0) or z (1), and the mean squared slope of stress."""
    low_y, high_y, low_z, high_z = shape.extent(s)
    low, high = [(low_y, high_y), (low_z, high_z)][axis]
    inside = (z > low) & (z < high)
    if isinstance(shape, Rectangle):
        width = [shape.height, shape.width][axis].at(s)
        return np.where(inside, width, 0.0), np.zeros_like(z)
    return _chord(shape, axis, np.where(inside, z, low), s)


def _chord(shape: Sector, axis: int, z: Array, s: float) -> tuple[Array, Array]:
    """Return the same of a sector at places `z` inside its extent."""
    along = (z - shape.y.at(s)) / shape.ratio if axis == 0 else z - shape.z.at(s)
    square = along**2
    outer, inner = (
        np.sqrt(np.maximum(radius.at(s) ** 2 - square, 0.0))
        for radius in (shape.outer, shape.inner)
    )
    sides, aspect = (1.0 if shape.half else 2.0, 1.0 / shape.ratio)
    if axis == 1:
        sides, aspect = 2.0 * shape.ratio, shape.ratio
    # Along the walls of a ring, and in a cap in proportion to the distance from its middle.
    between = np.where(inner > 0.0, inner, 3.0 * outer) * outer
    slope = np.divide(square, between, out=np.zeros_like(z), where=between > 0.0)
    return sides * (outer - inner), aspect**2 * slope


@lru_cache(maxsize=1)
def _rule() -> tuple[Array, Array, Array]:
    """Return nodes and weights on [-1, 1], and those of integrals from each node to 1.

    Gauss's, in the angle whose sine is the place: widths end like square roots.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    rate = 0.5 * pi * np.cos(0.5 * pi * nodes)
    legendre = np.polynomial.legendre.legvander(nodes, _NODES)
    after = np.zeros((_NODES, _NODES))
    for k in range(_NODES):
        tail = 1.0 - nodes if k == 0 else (legendre[:, k - 1] - legendre[:, k + 1]) / (2 * k + 1)
        after += (0.5 * (2 * k + 1) * weights * legendre[:, k])[:, None] * tail
    return np.sin(0.5 * pi * nodes), weights * rate, rate[:, None] * after
