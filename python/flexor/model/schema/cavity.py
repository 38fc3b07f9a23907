"""Areas and moments on which the pressure in a cavity acts."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from flexor.arrays import Array
from flexor.model.schema.body import Rod
from flexor.model.schema.section_geometry import Materials, gauss_points, geometries
from flexor.sections import Cavity
from flexor.sections.linear import at
from flexor.sections.shapes import moments


@lru_cache(maxsize=64)
def _rule(points: int) -> tuple[Array, Array]:
    x, w = np.polynomial.legendre.leggauss(points)
    return 0.5 * (x + 1.0), 0.5 * w


def lower_cavity(
    rod: Rod, cavity: str, span: tuple[float, float], materials: Materials
) -> dict[str, Any]:
    """Describe the area on which the pressure in a cavity acts to the engine.

    Parameters
    ----------
    rod
        The rod.
    cavity
        Name of the cavity.
    span
        Where it is, X in [0, 1].
    materials
        The materials of the file.
    """
    built, of_gauss = geometries(rod, materials)
    none = Cavity((), ())
    cavities = [none if each is None else each.cavities.get(cavity, none) for _, each in built]
    acting = np.stack([moments(each.enclosed) for each in cavities])
    solid = (acting - np.stack([moments(each.shapes) for each in cavities]))[of_gauss]
    s = rod.surface.radius[gauss_points(rod)]
    area, y, z = (at(part, s) for part in np.split(solid, [3, 7], axis=1))
    curved = rod.reference_strain
    swept = area * curved.extend_x + z * curved.bend_y - y * curved.bend_z
    share, weights = _shares(rod, span)
    return {
        "sections": acting.tolist(),
        "of_gauss": of_gauss,
        "share": share.tolist(),
        "enclosed": float(np.cumsum(weights * share * float(rod.length) * swept)[-1]),
    }


def quadrature(rod: Rod, span: tuple[float, float]) -> Array:
    """Return the weights of a rod's Gauss points for an integral over a span, X in [0, 1]."""
    share, weights = _shares(rod, span)
    return share * weights


def _shares(rod: Rod, span: tuple[float, float]) -> tuple[Array, Array]:
    """Return the share of each Gauss point's weight in a span, and the weights.

    Within an element that the span covers in part, the weights integrate over that part the
    polynomials through the Gauss points.
    """
    nodes, weights = _rule(rod.gauss_points)
    begin, end = (np.clip(x * rod.elements - np.arange(rod.elements), 0.0, 1.0) for x in span)
    share = np.repeat((end - begin)[:, None], rod.gauss_points, axis=1)
    for element in np.flatnonzero((share[:, 0] > 0.0) & (share[:, 0] < 1.0)):
        low, covered = begin[element], end[element] - begin[element]
        for k in range(rod.gauss_points):
            others = np.delete(nodes, k)
            inside = low + covered * nodes
            values = np.prod((inside[:, None] - others) / (nodes[k] - others), axis=1)
            share[element, k] = covered * (weights @ values) / weights[k]
    return share.ravel(), np.tile(weights / rod.elements, rod.elements)
