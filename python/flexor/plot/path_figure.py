"""The figure of one design: every load step in place, one over the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexor.plot import arrows, planar, spatial
from flexor.plot.history import History, draw_history
from flexor.plot.scene import Scene
from flexor.plot.style import CHAMBER, COLUMN, LINE, shades, style

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

MOST_IN_LEGEND = 12
PANEL = 0.9
MOST_IN_ROW = 6


def draw_path(
    scenes: Sequence[Scene],
    loads: ArrayLike,
    *,
    planar_model: bool,
    load_unit: str = "N",
    history: History | None = None,
) -> Figure:
    """Draw a model at every load step, to scale.

    Parameters
    ----------
    scenes : sequence of Scene
        One for each load step.
    loads : array_like, shape (s,)
        The loads, for the legend [load_unit].
    planar_model : bool
        Draw in the plane; otherwise in space.
    load_unit : str
        Of the loads.
    history : History, optional
        What a panel below shows over the load.

    Returns
    -------
    matplotlib.figure.Figure
        As wide as a column. Rods are coloured by load; arrows are the contact forces on the limb.
    """
    from matplotlib.figure import Figure

    values = np.asarray(loads, dtype=np.float64)
    colours = [tuple(shade) for shade in shades(len(scenes))]
    cm_per_newton, key = arrows.scale(scenes)
    with style():
        figure = Figure(figsize=(COLUMN, 0.95 * COLUMN), layout="constrained")
        place, panel = figure.add_gridspec(1, 1)[0], None
        if history is not None:
            # The upper part is as high as it would be alone.
            place, below = figure.add_gridspec(2, 1, height_ratios=(1.0, PANEL))
            panel = figure.add_subplot(below)
        if planar_model:
            axes = figure.add_subplot(place)
            planar.frame_axes(axes, scenes, with_key=key > 0.0)
            figure.set_figheight(planar.height(axes, COLUMN - 0.6) + 1.2)
            for step, (scene, colour) in enumerate(zip(scenes, colours, strict=True)):
                planar.draw_scene(axes, scene, colour=colour, opacity=0.8, depth=2.0 + step)
                planar.draw_pushes(axes, scene, cm_per_newton=cm_per_newton, colour=colour)
            if key:
                planar.draw_key(axes, cm_per_newton=cm_per_newton, force=key)
        else:
            space = figure.add_subplot(place, projection="3d", computed_zorder=False)
            spatial.frame_axes(space, scenes)
            for scene, colour in zip(scenes, colours, strict=True):
                spatial.draw_scene(space, scene, colour=colour, opacity=0.8)
                spatial.draw_pushes(space, scene, cm_per_newton=cm_per_newton, colour=colour)
        if panel is not None and history is not None:
            draw_history(panel, history, load_unit)
            figure.set_figheight((1.0 + PANEL) * figure.get_figheight())
        _legends(figure, _load_handles(values, colours, load_unit), _line_handles(scenes))
    return figure


def _legends(figure: Figure, loads: list[Artist], lines: list[Artist]) -> None:
    columns = -(-len(loads) // -(-len(loads) // MOST_IN_ROW))
    # Matplotlib fills column by column; loads read better row by row.
    by_column = [handle for column in range(columns) for handle in loads[column::columns]]
    figure.legend(
        handles=by_column,
        loc="outside upper center",
        ncols=columns,
        handlelength=1.0,
        handletextpad=0.5,
        columnspacing=1.0,
    )
    if lines:
        figure.legend(handles=lines, loc="outside lower center", ncols=2, handlelength=1.4)


def _load_handles(
    loads: NDArray[np.float64], colours: Sequence[tuple[float, ...]], unit: str
) -> list[Artist]:
    from matplotlib.patches import Patch

    # A long path would drown the figure in its legend: then only some steps are named.
    every = -(-len(loads) // MOST_IN_LEGEND)
    chosen = sorted({*range(0, len(loads), every), len(loads) - 1})
    return [
        Patch(facecolor=colours[i], edgecolor=LINE, linewidth=0.5, label=f"{loads[i]:g} {unit}")
        for i in chosen
    ]


def _line_handles(scenes: Sequence[Scene]) -> list[Artist]:
    from matplotlib.lines import Line2D

    labels = dict.fromkeys(line.label for scene in scenes for line in scene.lines)
    return [Line2D([], [], color=CHAMBER, label=label) for label in labels]
