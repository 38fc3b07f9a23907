"""Drawing of models in three dimensions with their sections as they are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.plot.style import EXOSUIT, FINGER, FORCE, STRAP, material_shades
from flexor.plot.surroundings import SPRING
from flexor.scene.pressure import FIELD

if TYPE_CHECKING:
    from matplotlib.typing import ColorType
    from mpl_toolkits.mplot3d import Axes3D

    from flexor.scene import Scene

CM = 100.0
# From where the light comes, and how dark surfaces along it are.
LIGHT, SHADE = np.array([-0.4, -0.7, 0.6]), 0.55
# How far straps are drawn towards the eye, since triangles are sorted by their middles [m].
NEARER = 2e-3
# Cosine beyond which closed surfaces face away from the eye, also where perspective turns its rays.
AWAY = -0.2
_HIDDEN = ("chamber", "line", "obstacle", "tie")


def solid_colours(scenes: list[Scene]) -> dict[str, ColorType]:
    """Return the colour of each material of rods."""
    return material_shades(
        each.part for scene in scenes for each in scene.objects if each.kind == "rod" and each.part
    )


def largest_pressure(scenes: list[Scene]) -> float:
    """Return the largest pressure of contact on links at the last step [Pa]."""
    values = [
        each.fields[FIELD][-1]
        for scene in scenes
        for each in scene.objects
        if each.kind == "link" and FIELD in each.fields
    ]
    return max((float(np.nan_to_num(each).max()) for each in values), default=0.0)


def draw_solid(
    axes: Axes3D, scene: Scene, step: int, colours: Mapping[str, ColorType], largest: float
) -> None:
    """Draw the surfaces of a scene in one step, in centimetres.

    Parameters
    ----------
    axes
        The axes.
    scene
        The scene.
    step
        The load step.
    colours
        Of each material of rods.
    largest
        Pressure of contact that has the full colour [Pa].
    """
    from matplotlib.colors import to_rgb
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    kinds = {"link": FINGER, "strap": STRAP, "spring": SPRING, "rod": EXOSUIT}
    elevation, azimuth = np.radians([axes.elev, axes.azim])
    eye = np.array([np.cos(azimuth), np.sin(azimuth), np.tan(elevation)]) * np.cos(elevation)
    triangles, shown = [], []
    for each in scene.objects:
        if each.kind in _HIDDEN or each.part == "bone":
            continue
        corners = each.vertices(step)[each.faces]
        if each.kind == "strap":
            corners = corners + NEARER * eye
        plain = colours.get(each.part, kinds[each.kind]) if each.kind == "rod" else kinds[each.kind]
        colour = np.broadcast_to(to_rgb(plain), (len(corners), 3))
        if FIELD in each.fields and each.kind == "link" and largest > 0.0:
            pressure = np.nan_to_num(each.fields[FIELD][step])[each.faces].mean(axis=1)
            share = np.clip(pressure / largest, 0.0, 1.0)[:, None]
            colour = (1.0 - share) * colour + share * np.array(to_rgb(FORCE))
        if each.kind in ("link", "rod"):  # closed, and hidden by their own front
            facing = _normals(corners) @ eye > AWAY
            corners, colour = corners[facing], colour[facing]
        triangles.append(corners)
        shown.append(colour * _lightness(corners)[:, None])
    # One collection, in which the nearer hides what is behind it.
    every = np.concatenate(shown)
    surface = Poly3DCollection(list(CM * np.concatenate(triangles)), linewidths=0.15, zorder=5)
    surface.set(facecolors=every, edgecolors=every, rasterized=True)
    axes.add_collection3d(surface)


def _lightness(corners: Array) -> Array:
    """Return how light triangles (f, 3, 3) are, (f,)."""
    across = np.abs(_normals(corners) @ LIGHT) / np.linalg.norm(LIGHT)
    return np.asarray(SHADE + (1.0 - SHADE) * across)


def _normals(corners: Array) -> Array:
    """Return the normals (f, 3) of triangles (f, 3, 3)."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-30)[:, None]
    return np.asarray(normal)
