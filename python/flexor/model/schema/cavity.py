"""Areas and moments on which the pressure in a cavity acts."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from flexor.arrays import Array
from flexor.model.schema.body import Rod
from flexor.model.schema.profile import surface
from flexor.model.schema.section_geometry import Materials, gauss_points, geometries
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
    cavities = [None if each is None else each.cavities.get(cavity) for _, each in built]
    points = gauss_points(rod)
    radius, _ = surface(rod.radius, rod.sample_points)
    share, weights = _shares(rod, span)
    enclosed = 0.0
    for place, point in enumerate(points):
        hollow = cavities[of_gauss[place]]
        if hollow is None:
            continue
        s = float(radius[point])
        solid = moments(hollow.enclosed) - moments(hollow.shapes)
        curved = [
            float(getattr(rod.reference_strain, key)) for key in ("extend_x", "bend_y", "bend_z")
        ]
        area, y, z = _at(solid, s)
        swept = area * curved[0] + z * curved[1] - y * curved[2]
        enclosed += weights[place] * share[place] * float(rod.length) * swept
    return {
        "sections": [moments(() if each is None else each.enclosed).tolist() for each in cavities],
        "of_gauss": of_gauss,
        "share": share.tolist(),
        "enclosed": enclosed,
    }


def quadrature(rod: Rod, span: tuple[float, float]) -> Array:
    """Return the weights of a rod's Gauss points for an integral over a span, X in [0, 1]."""
    share, weights = _shares(rod, span)
    return share * weights


def _at(coefficients: Array, s: float) -> tuple[float, float, float]:
    parts = (coefficients[:3], coefficients[3:7], coefficients[7:])
    area, y, z = (float(np.polynomial.polynomial.polyval(s, part)) for part in parts)
    return area, y, z


def _shares(rod: Rod, span: tuple[float, float]) -> tuple[Array, Array]:
    """Return the share of each Gauss point's weight in a span, and the weights.

    Within an element that the span covers in part, the weights integrate over that part the
    polynomials through the Gauss points.
    """
    nodes, weights = _rule(rod.gauss_points)
    share = np.zeros((rod.elements, rod.gauss_points))
    inner, inner_weights = _rule(rod.gauss_points)
    for element in range(rod.elements):
        low, high = np.clip(np.array(span) * rod.elements - element, 0.0, 1.0)
        if high - low == 1.0:
            share[element] = 1.0
            continue
        for k in range(rod.gauss_points):
            others = np.delete(nodes, k)
            at = low + (high - low) * inner
            values = np.prod((at[:, None] - others) / (nodes[k] - others), axis=1)
            share[element, k] = (high - low) * (inner_weights @ values) / weights[k]
    return share.ravel(), np.tile(weights / rod.elements, rod.elements)
