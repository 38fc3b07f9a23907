"""Drawing of spatial scenes to scale."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.plot.outline import tube
from flexor.plot.scene import Link, Scene
from flexor.plot.style import EXOSUIT, FINGER, FORCE, MARK

if TYPE_CHECKING:
    from matplotlib.typing import ColorType
    from mpl_toolkits.mplot3d import Axes3D

CM = 100.0
MARGIN = 0.5  # cm, around the bodies
ELEVATION, AZIMUTH = 18.0, -62.0  # of the eye [deg]
# How long x, y and z seem from there; y is at the margin, where perspective shortens it further.
SEEN = np.array([0.9, 0.35, 0.95])


def draw_scene(
    axes: Axes3D, scene: Scene, *, colour: ColorType = EXOSUIT, opacity: float = 1.0
) -> None:
    """Draw the bodies and lines of a scene, in centimetres."""
    for rod in scene.rods:
        width = rod.half_width[:, None] * rod.frames[:, :3, 1]
        height = rod.half_height[:, None] * rod.frames[:, :3, 2]
        x, y, z = tube(rod.frames[:, :3, 3], width, height)
        axes.plot_surface(
            CM * x, CM * y, CM * z, color=colour, alpha=0.8 * opacity, linewidth=0.0, shade=True
        )
    for link in scene.links:
        x, y, z = _round_cone(link)
        # Only rods have the colour of the load, where there are any.
        shown = FINGER if scene.rods else colour
        axes.plot_surface(
            CM * x, CM * y, CM * z, color=shown, alpha=0.8 * opacity, linewidth=0.0, shade=True
        )
    for line in scene.lines:
        axes.plot(*(CM * line.points.T), color=line.colour, linewidth=1.2, zorder=10)
    for mark in scene.marks:
        axes.plot(*(CM * mark.point[:, None]), mark.symbol, **MARK | mark.style, zorder=60.0)


def draw_contact_forces(
    axes: Axes3D, scene: Scene, *, cm_per_newton: float, colour: ColorType = FORCE
) -> None:
    """Draw the contact forces of a scene as arrows that end at their points of application."""
    if not scene.contact_arrows:
        return
    points = CM * np.array([arrow.point for arrow in scene.contact_arrows])
    arrows = cm_per_newton * np.array([arrow.force for arrow in scene.contact_arrows])
    axes.quiver(*(points - arrows).T, *arrows.T, color=colour, linewidth=1.0)


def frame_axes(axes: Axes3D, scenes: Sequence[Scene]) -> None:
    """Set equal scales in centimetres and limits that include every scene."""
    from matplotlib.ticker import MaxNLocator

    corners = [scene.extent() for scene in scenes]
    low = CM * np.min([c[0] for c in corners], axis=0) - MARGIN
    high = CM * np.max([c[1] for c in corners], axis=0) + MARGIN
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set(xlabel="x / cm", ylabel="y / cm", zlabel="z / cm")
    axes.set_box_aspect(tuple(high - low), zoom=0.82)
    axes.view_init(elev=ELEVATION, azim=AZIMUTH)
    # Number of ticks proportional to the side as it is seen, so that labels do not overlap.
    sides = (high - low) * SEEN
    for axis, size in zip((axes.xaxis, axes.yaxis, axes.zaxis), sides, strict=True):
        count = round(6 * size / float(np.max(sides)))
        if count > 1:
            axis.set_major_locator(MaxNLocator(count))
        else:
            axis.set_ticks([round(0.5 * sum(axis.get_view_interval()))])


def _round_cone(link: Link) -> tuple[Array, Array, Array]:
    """Return the surface of a link, whose ends are halves of spheres."""
    axis = link.tip - link.base
    length = float(np.linalg.norm(axis))
    along = axis / length if length > 0.0 else np.array([1.0, 0.0, 0.0])
    # Two normals to the axis, from the coordinate direction that is least parallel to it.
    other = np.eye(3)[int(np.argmin(np.abs(along)))]
    first = np.cross(along, other)
    first /= np.linalg.norm(first)
    second = np.cross(along, first)
    angle = np.linspace(0.0, 0.5 * np.pi, 7)
    share = np.linspace(0.0, 1.0, 12)
    ends = link.radius_base, link.radius_tip
    places = np.concatenate(
        [-ends[0] * np.cos(angle), length * share, length + ends[1] * np.sin(angle)]
    )
    radius = np.concatenate(
        [ends[0] * np.sin(angle), ends[0] + share * (ends[1] - ends[0]), ends[1] * np.cos(angle)]
    )[:, None]
    return tube(link.base + places[:, None] * along, radius * first, radius * second)
