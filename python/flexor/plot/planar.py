"""Scenes in their plane: x to the right, z up, to scale."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexor.plot.outline import band, capsule
from flexor.plot.scene import Push, Scene
from flexor.plot.style import CHAMBER, EXOSUIT, FINGER, FORCE, LINE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.typing import ColorType

CM = 100.0
KEY_ROOM = 1.6  # cm, from the lower edge of the axes to the lowest body
PLANE = (0, 2)


def draw_scene(
    axes: Axes,
    scene: Scene,
    *,
    colour: ColorType = EXOSUIT,
    opacity: float = 1.0,
    depth: float = 1.0,
) -> None:
    """Draw the bodies and lines of a scene, in centimetres.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to.
    scene : Scene
        What to draw.
    colour : colour
        Fill of the rods and edge of the links.
    opacity : float
        Of the fills, 0 to 1.
    depth : float
        Drawing order; a scene of greater depth covers one of less.
    """
    for link in scene.links:
        outline = capsule(_flat(link.base), _flat(link.tip), link.radius_base, link.radius_tip)
        axes.fill(
            *(CM * outline.T),
            facecolor=_fade(FINGER, 0.9 * opacity),
            edgecolor=LINE if colour == EXOSUIT else colour,
            zorder=depth,
        )
        if link.moves:
            axes.plot(*(CM * _flat(link.base)), "o", color=LINE, markersize=1.8, zorder=depth + 0.2)
    for rod in scene.rods:
        centre, normal = _flat(rod.frames[:, :3, 3]), _flat(rod.frames[:, :3, 2])
        axes.fill(
            *(CM * band(centre, normal, rod.half_height).T),
            facecolor=_fade(colour, 0.9 * opacity),
            edgecolor=LINE,
            linewidth=0.5,
            zorder=depth + 0.3,
        )
    for line in scene.lines:
        axes.plot(*(CM * _flat(line.points).T), color=CHAMBER, linewidth=1.0, zorder=depth + 0.4)


def draw_pushes(
    axes: Axes,
    scene: Scene,
    *,
    cm_per_newton: float,
    colour: ColorType = FORCE,
    depth: float = 50.0,
) -> None:
    """Draw the contact forces of a scene as arrows that end where they act.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to.
    scene : Scene
        Whose forces.
    cm_per_newton : float
        Length of an arrow per newton [cm/N].
    colour : colour
        Of the arrows.
    depth : float
        Drawing order.
    """
    if not scene.pushes:
        return
    points = CM * np.array([_flat(push.point) for push in scene.pushes])
    arrows = cm_per_newton * np.array([_flat(push.force) for push in scene.pushes])
    axes.quiver(
        *points.T,
        *arrows.T,
        pivot="tip",
        angles="xy",
        scale_units="xy",
        scale=1.0,
        units="inches",
        width=0.014,
        headwidth=3.6,
        headlength=4.2,
        headaxislength=3.8,
        color=colour,
        zorder=depth,
    )


def draw_key(axes: Axes, *, cm_per_newton: float, force: float, colour: ColorType = LINE) -> None:
    """Draw the scale of the contact forces into the lower left corner.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to; its limits must be set.
    cm_per_newton : float
        Length of an arrow per newton [cm/N].
    force : float
        The force that the key shows [N].
    colour : colour
        Of the arrow.
    """
    left, right = axes.get_xlim()
    bottom, _ = axes.get_ylim()
    x, y = left + 0.04 * (right - left), bottom + 0.5 * KEY_ROOM
    scene = Scene(pushes=[Push(_deep(x + cm_per_newton * force, y), np.array([force, 0.0, 0.0]))])
    draw_pushes(axes, scene, cm_per_newton=cm_per_newton, colour=colour)
    axes.annotate(
        f"contact force {force:g} N",
        (x + cm_per_newton * force, y),
        xytext=(4, 0),
        textcoords="offset points",
        va="center",
        fontsize=7,
    )


def frame_axes(
    axes: Axes, scenes: Sequence[Scene], *, margin: float = 0.6, with_key: bool = False
) -> None:
    """Give the axes equal scales, centimetres, and room for every scene.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Whose limits.
    scenes : sequence of Scene
        What has to fit.
    margin : float
        Room around it [cm].
    with_key : bool
        Leave room for the key of the contact forces below it.
    """
    corners = [scene.extent() for scene in scenes]
    low = CM * np.min([_flat(c[0]) for c in corners], axis=0) - margin
    high = CM * np.max([_flat(c[1]) for c in corners], axis=0) + margin
    if with_key:
        low[1] -= KEY_ROOM - margin
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="x / cm", ylabel="z / cm")
    axes.set_aspect("equal")


def height(axes: Axes, width: float) -> float:
    """Return how high the axes are if they are so wide; both in one unit."""
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    return width * (top - bottom) / (right - left)


def _deep(x: float, z: float) -> NDArray[np.float64]:
    return np.array([x / CM, 0.0, z / CM])


def _flat(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    return vectors[..., PLANE]


def _fade(colour: ColorType, opacity: float) -> tuple[float, float, float, float]:
    from matplotlib.colors import to_rgba

    return to_rgba(colour, opacity)
