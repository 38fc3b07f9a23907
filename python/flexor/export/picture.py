"""Pictures of solids, shaded, to scale."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.export.solids import Solid, triangles

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LIGHT = np.array([0.35, -0.45, 0.82])


def draw(
    axes: Axes,
    solids: Mapping[str, tuple[Solid, str]],
    azimuth: float = -55.0,
    elevation: float = 28.0,
) -> None:
    """Draw solids with their colours in parallel projection, in mm.

    Parameters
    ----------
    axes
        Plane axes, whose frame is removed.
    solids
        Solid and colour by name.
    azimuth, elevation
        From where they are seen [degrees]: at an azimuth of 0 from the tip.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb

    a, e = np.radians([azimuth, elevation])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    towards = np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
    up = np.cross(towards, right)
    polygons, colours, depths = [], [], []
    for solid, colour in solids.values():
        corners = _fine(solid)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        size = np.linalg.norm(normal, axis=1)
        keep = size > 1e-12
        corners, normal = corners[keep], normal[keep] / size[keep, None]
        seen = normal @ towards > 0.0
        corners, normal = corners[seen], normal[seen]
        shade = 0.45 + 0.55 * np.clip(normal @ (_LIGHT / np.linalg.norm(_LIGHT)), 0.0, 1.0)
        polygons.append(np.stack([corners @ right, corners @ up], axis=-1))
        colours.append(shade[:, None] * np.array(to_rgb(colour)))
        depths.append((corners @ towards).mean(axis=1))
    order = np.argsort(np.concatenate(depths))
    flat = np.concatenate(polygons)[order]
    shades = np.concatenate(colours)[order]
    axes.add_collection(
        PolyCollection(flat, facecolors=shades, edgecolors=shades, linewidths=0.3, rasterized=True)  # type: ignore[arg-type]
    )
    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    margin = 0.03 * float((high - low).max())
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _fine(solid: Solid) -> Array:
    """Return triangles (t, 3, 3) of a solid, small enough to be ordered by their depth."""
    low_x, low_y, low_z, high_x, high_y, high_z = solid.bounding_box()
    size = max(high_x - low_x, high_y - low_y, high_z - low_z)
    points, faces = triangles(solid.refine_to_length(0.03 * size))
    return np.asarray(points[faces])
