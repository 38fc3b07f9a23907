"""Drawing of planar scenes to scale: x to the right, z up."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.plot.lengthwise import CAVITY
from flexor.plot.outline import band, capsule
from flexor.plot.scene import ContactArrow, Scene, enlarged
from flexor.plot.style import AIR, EXOSUIT, FINGER, FORCE, LINE, MARK, material_shades
from flexor.plot.surroundings import SPRING

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.typing import ColorType

CM = 100.0
MARGIN = 0.6  # cm, around the bodies
KEY_MARGIN = 1.6  # cm, of each key below the lowest body; see `enlarged`
MAX_ASPECT = 2.0  # height over width
PLANE = (0, 2)


def draw_scene(
    axes: Axes,
    scene: Scene,
    *,
    colour: ColorType = EXOSUIT,
    opacity: float = 1.0,
    depth: float = 1.0,
    sections: bool = False,
) -> None:
    """Draw the bodies and lines of a scene, in centimetres.

    With ``sections``, rods are cut lengthwise: their first material has the colour.
    """
    for link in scene.links:
        outline = capsule(
            _in_plane(link.base), _in_plane(link.tip), link.radius_base, link.radius_tip
        )
        axes.fill(
            *(CM * outline.T),
            facecolor=_fade(FINGER, 0.9 * opacity),
            edgecolor=LINE if colour == EXOSUIT else colour,
            zorder=depth,
        )
        if link.moves:
            axes.plot(
                *(CM * _in_plane(link.base)), "o", color=LINE, markersize=1.8, zorder=depth + 0.2
            )
    for rod in scene.rods:
        centre, normal = _in_plane(rod.frames[:, :3, 3]), _in_plane(rod.frames[:, :3, 2])
        cut = rod.bands if sections else []
        colours = material_colours([scene], colour)
        for each in cut:
            there = np.isfinite(each.low)
            edges = [centre + end[:, None] * normal for end in (each.low, each.high)]
            whole = np.concatenate([edges[0][there], edges[1][there][::-1]])
            axes.fill(
                *(CM * whole.T), facecolor=colours[each.name], linewidth=0.0, zorder=depth + 0.25
            )
        axes.fill(
            *(CM * band(centre, normal, rod.half_height).T),
            facecolor="none" if cut else _fade(colour, 0.9 * opacity),
            edgecolor=LINE,
            linewidth=0.5,
            zorder=depth + 0.3,
        )
    for line in scene.lines:
        axes.plot(
            *(CM * _in_plane(line.points).T), color=line.colour, linewidth=1.0, zorder=depth + 0.4
        )
    for mark in scene.marks:
        axes.plot(*(CM * _in_plane(mark.point)), mark.symbol, **MARK | mark.style, zorder=60.0)


def material_colours(scenes: Sequence[Scene], colour: ColorType = EXOSUIT) -> dict[str, ColorType]:
    """Return the colour of each material and of cavities in rods that are cut lengthwise."""
    names = [each.name for scene in scenes for rod in scene.rods for each in rod.bands]
    found: dict[str, ColorType] = material_shades(
        (name for name in names if name != CAVITY), colour
    )
    return found | {CAVITY: AIR} if CAVITY in names else found


def draw_pressure(axes: Axes, scene: Scene, *, cm_per_pascal: float) -> None:
    """Draw the pressure of contact as heights below the rods' undersides."""
    for each in scene.pressures:
        line, down = CM * _in_plane(each.points), _in_plane(each.down)
        foot = line + cm_per_pascal * each.values[:, None] * down
        touched = np.flatnonzero(each.values)
        # From the last point before to the first after those that touch.
        rows = slice(max(touched[0] - 1, 0), touched[-1] + 2)
        outline = np.concatenate([line[rows], foot[rows][::-1]])
        axes.fill(
            *outline.T, facecolor=_fade(FORCE, 0.45), edgecolor=FORCE, linewidth=0.6, zorder=40.0
        )


def draw_outlines(axes: Axes, scene: Scene, *, colour: ColorType, depth: float = 1.0) -> None:
    """Draw only the outlines of the bodies of a scene, and its springs, in centimetres."""
    outlines = [
        (capsule(_in_plane(each.base), _in_plane(each.tip), each.radius_base, each.radius_tip), 0.4)
        for each in scene.links
    ]
    for rod in scene.rods:
        centre, normal = _in_plane(rod.frames[:, :3, 3]), _in_plane(rod.frames[:, :3, 2])
        outlines.append((band(centre, normal, rod.half_height), 0.8))
    outlines += [(_in_plane(each.points), 0.5) for each in scene.lines if each.colour == SPRING]
    for line, width in outlines:
        axes.plot(*(CM * line.T), color=colour, linewidth=width, zorder=depth)


def draw_contact_forces(
    axes: Axes, scene: Scene, *, cm_per_newton: float, colour: ColorType = FORCE
) -> None:
    """Draw the contact forces of a scene as arrows that end at their points of application."""
    if not scene.contact_arrows:
        return
    points = CM * np.array([_in_plane(arrow.point) for arrow in scene.contact_arrows])
    arrows = cm_per_newton * np.array([_in_plane(arrow.force) for arrow in scene.contact_arrows])
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
        zorder=50.0,
    )


def draw_keys(
    axes: Axes,
    forces: tuple[float, float],
    pressures: tuple[float, float] = (0.0, 0.0),
    gravity: Array | None = None,
) -> None:
    """Draw keys at lower left.

    Parameters
    ----------
    axes
        The axes, framed.
    forces, pressures
        Scale and value of contact forces and pressures; the value is 0 for no key.
    gravity : (3,) array, optional
        Its direction; none for no key.
    """
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    height = enlarged(KEY_MARGIN, right - left) * (1.0 if top > bottom else -1.0)
    x, y = left + 0.04 * (right - left), bottom + 0.5 * height
    if forces[1]:
        _draw_force_key(axes, x, y, *forces)
    if pressures[1]:
        scale, value = pressures
        y += height if forces[1] else 0.0
        axes.plot([x, x], [y - 0.5 * scale * value, y + 0.5 * scale * value], color=FORCE)
        axes.annotate(
            f"contact pressure {value / 1e3:g} kPa", (x, y), xytext=(4, 0),
            textcoords="offset points", va="center", fontsize=7,
        )  # fmt: skip
        y += height
    if gravity is not None and _in_plane(gravity).any():
        _draw_gravity(axes, x, y, abs(height), gravity)


def _draw_gravity(axes: Axes, x: float, y: float, height: float, gravity: Array) -> None:
    """Draw an arrow along gravity to the right of x, its middle at the height y, in cm."""
    along = 0.6 * height * _in_plane(gravity) / float(np.linalg.norm(_in_plane(gravity)))
    middle = np.array([x + abs(0.5 * along[0]), y])
    tip = np.zeros(3)
    tip[list(PLANE)] = (middle + 0.5 * along) / CM
    force = np.zeros(3)
    force[list(PLANE)] = along
    arrow = Scene(contact_arrows=[ContactArrow(tip, force)])
    draw_contact_forces(axes, arrow, cm_per_newton=1.0, colour=LINE)
    axes.annotate(
        "gravity", (x + abs(along[0]), y), xytext=(6, 0), textcoords="offset points",
        va="center", fontsize=7,
    )  # fmt: skip


def _draw_force_key(axes: Axes, x: float, y: float, cm_per_newton: float, force: float) -> None:
    tip = np.array([x + cm_per_newton * force, 0.0, y]) / CM
    arrow = ContactArrow(tip, np.array([force, 0.0, 0.0]))
    scene = Scene(contact_arrows=[arrow])
    draw_contact_forces(axes, scene, cm_per_newton=cm_per_newton, colour=LINE)
    axes.annotate(
        f"contact force {force:g} N",
        (x + cm_per_newton * force, y),
        xytext=(4, 0),
        textcoords="offset points",
        va="center",
        fontsize=7,
    )


def frame_axes(axes: Axes, scenes: Sequence[Scene], *, keys: int = 0) -> None:
    """Set equal scales in centimetres and limits that include every scene and some keys.

    z points up, or down where gravity acts along it; a model with gravity has a key more.
    """
    keys += bool(_in_plane(scenes[0].gravity).any())
    down = _is_upside_down(scenes[0])
    corners = [scene.extent() for scene in scenes]
    low = CM * np.min([_in_plane(c[0]) for c in corners], axis=0) - MARGIN
    high = CM * np.max([_in_plane(c[1]) for c in corners], axis=0) + MARGIN
    if keys:
        width = max(high[0] - low[0], (high[1] - low[1]) / MAX_ASPECT)
        room = keys * enlarged(KEY_MARGIN, width) - MARGIN
        low[1], high[1] = (low[1], high[1] + room) if down else (low[1] - room, high[1])
    # A model that is much higher than wide gets room beside it, not a figure of many pages.
    room = max(0.0, (high[1] - low[1]) / MAX_ASPECT - (high[0] - low[0]))
    low[0], high[0] = low[0] - 0.5 * room, high[0] + 0.5 * room
    heights = (high[1], low[1]) if down else (low[1], high[1])
    axes.set(xlim=(low[0], high[0]), ylim=heights, xlabel="x / cm", ylabel="z / cm")
    axes.set_aspect("equal")


def height(axes: Axes, width: float) -> float:
    """Return the height of the axes for a given width, in the same unit."""
    left, right = axes.get_xlim()
    bottom, top = axes.get_ylim()
    return abs(width * (top - bottom) / (right - left))


def _is_upside_down(scene: Scene) -> bool:
    """Whether what is up, against gravity, is rather -z than another direction."""
    x, z = _in_plane(scene.gravity)
    return bool(z > abs(x))


def _in_plane(vectors: Array) -> Array:
    return vectors[..., PLANE]


def _fade(colour: ColorType, opacity: float) -> tuple[float, float, float, float]:
    from matplotlib.colors import to_rgba

    return to_rgba(colour, opacity)
