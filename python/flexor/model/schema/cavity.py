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
        "enclosed": (weights * float(rod.length) * swept).tolist(),
    }


def _shares(rod: Rod, span: tuple[float, float]) -> tuple[Array, Array]:
    """Return the share of each Gauss point's weight in a span, and the weights."""
    share, _ = shares(rod, np.array([span]))
    return share[0], rod.gauss_rule[1]


def shares(rod: Rod, spans: Array) -> tuple[Array, Array]:
    """Return the share of each Gauss point's weight in spans, and its slopes by their ends.

    Within an interval that a span covers in part, the weights integrate over that part the
    polynomials through the Gauss points. The slopes jump at ends of intervals, where they are
    those towards the inside of the span.

    Parameters
    ----------
    rod
        The rod, of g Gauss points.
    spans : (n, 2) array
        Begin and end, X in [0, 1].

    Returns
    -------
    share, slopes : (n, g), (n, g, 2) arrays
    """
    nodes, weights = _rule(rod.gauss_points)
    # In intervals from the base: those of the last element are shorter.
    place, last = spans * rod.elements, rod.elements - 1
    place += (rod.last_intervals - 1) * np.maximum(place - last, 0.0)
    counts = rod.interval_counts
    inside = place[:, None, :] - np.arange(len(counts))[:, None]
    ends = np.clip(inside, 0.0, 1.0)  # (n, intervals, 2)
    integral = np.zeros((*ends.shape, rod.gauss_points))
    for node, weight in zip(nodes, weights, strict=True):
        integral += weight * _basis(nodes, ends * node)
    integral *= ends[..., None]
    share = (integral[:, :, 1] - integral[:, :, 0]) / weights
    covered = (ends[:, :, 1] - ends[:, :, 0])[..., None]
    share = np.where((covered == 0.0) | (covered == 1.0), covered, share)
    partly = np.stack([(inside[..., 0] >= 0.0), (inside[..., 1] > 0.0)], axis=-1)
    partly &= np.stack([(inside[..., 0] < 1.0), (inside[..., 1] <= 1.0)], axis=-1)
    slopes = np.where(partly[..., None], _basis(nodes, ends) / weights, 0.0)
    slopes *= counts[:, None, None]
    slopes[:, :, 0] *= -1.0
    n = len(spans)
    return share.reshape(n, -1), np.moveaxis(slopes, 2, 3).reshape(n, -1, 2)


def _basis(nodes: Array, x: Array) -> Array:
    """Return the Lagrange polynomials of nodes at points (...), (..., k)."""
    found = np.ones((*x.shape, len(nodes)))
    for k, node in enumerate(nodes):
        for other in np.delete(nodes, k):
            found[..., k] *= (x - other) / (node - other)
    return found
