"""Figure of one design with all load steps superimposed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from flexor.arrays import Array
from flexor.plot import planar, spatial
from flexor.plot.history import History, draw_history
from flexor.plot.scene import Scene, arrow_scale, pressure_scale
from flexor.plot.solid import draw_solid, solid_colours
from flexor.plot.style import CHAMBER, COLUMN, LINE, MARK, literal, shades, style

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

    from flexor.scene import Scene as Solid

MAX_LEGEND_ENTRIES = 12
MAX_LEGEND_COLUMNS = 6
LONGEST_LINE = 52  # characters
# Height of a row of a legend [in], and how many there is room for without more.
ROW, USUAL_ROWS = 0.16, 5
# Height of the panel [in].
PANEL = 2.6


def draw_path(
    scenes: Sequence[Scene],
    loads: ArrayLike,
    *,
    planar_model: bool,
    history: History | None = None,
    unit: str = "N",
    inputs: str = "",
    solid: Solid | None = None,
) -> Figure:
    """Draw a model at every load step, to scale; in space, with `solid`, the last with surfaces.

    ``inputs`` says which of several inputs the loads are of, and what the others are.
    """
    from matplotlib.figure import Figure

    colours = [tuple(shade) for shade in shades(len(scenes))]
    cm_per_newton, key = arrow_scale(scenes[-1:])
    pressures = pressure_scale(scenes[-1:])
    with style():
        figure = Figure(figsize=(COLUMN, 0.95 * COLUMN), layout="constrained")
        grid = figure.add_gridspec(1 if history is None else 2, 1)
        place = grid[0]
        if planar_model:
            axes = figure.add_subplot(place)
            planar.frame_axes(axes, scenes, keys=(key > 0.0) + (pressures[1] > 0.0))
            figure.set_figheight(planar.height(axes, COLUMN - 0.6) + 1.2)
            for step, (scene, colour) in enumerate(zip(scenes, colours, strict=True)):
                # Outlines of the others over the last, which would hide them.
                if scene is scenes[-1]:
                    planar.draw_scene(axes, scene, colour=colour, opacity=0.6, depth=2.0)
                else:
                    planar.draw_outlines(axes, scene, colour=colour, depth=3.0 + step)
            planar.draw_pressure(axes, scenes[-1], cm_per_pascal=pressures[0])
            planar.draw_contact_forces(axes, scenes[-1], cm_per_newton=cm_per_newton)
            planar.draw_keys(axes, (cm_per_newton, key), pressures, scenes[-1].gravity)
        else:
            space = figure.add_subplot(place, projection="3d", computed_zorder=False)
            spatial.frame_axes(space, scenes)
            for scene, colour in zip(scenes, colours, strict=True):
                last = scene is scenes[-1]
                shown = scene if last else replace(scene, lines=[], marks=[])
                if last and solid is not None:
                    # One colour, that of the load.
                    materials = dict.fromkeys(solid_colours([solid]), colour)
                    draw_solid(space, solid, -1, materials, 0.0)
                    within = [line for line in scene.lines if line.colour == CHAMBER]
                    shown = replace(scene, rods=[], links=[], lines=within)
                spatial.draw_scene(space, shown, colour=colour, opacity=0.8 if last else 0.3)
            spatial.draw_contact_forces(space, scenes[-1], cm_per_newton=cm_per_newton)
        if history is not None:
            draw_history(figure.add_subplot(grid[1]), history)
            height = figure.get_figheight()
            grid.set_height_ratios((height, PANEL))
            figure.set_figheight(height + PANEL)
        handles = _load_handles(np.asarray(loads), colours, unit)
        _legends(figure, handles, line_handles(scenes), inputs)
    return figure


def _legends(figure: Figure, loads: list[Artist], lines: list[Artist], title: str) -> None:
    long = max(len(str(load.get_label())) for load in loads) > 5
    most = MAX_LEGEND_COLUMNS - 2 if long else MAX_LEGEND_COLUMNS
    columns = -(-len(loads) // -(-len(loads) // most))
    # Matplotlib fills legends by column; order the entries by row.
    by_column = [handle for column in range(columns) for handle in loads[column::columns]]
    figure.legend(
        handles=by_column,
        loc="outside upper center",
        ncols=columns,
        handlelength=1.0,
        handletextpad=0.5,
        columnspacing=1.0,
        title=fill(literal(title), LONGEST_LINE) or None,
        title_fontsize=7.5,
    )
    rows = -(-len(loads) // columns)
    if lines:
        # Marks have long labels.
        columns = 2 if all(len(str(line.get_label())) < 25 for line in lines) else 1
        rows += -(-len(lines) // columns)
        room = ROW * max(0, rows - USUAL_ROWS)
        figure.set_figheight(figure.get_figheight() + room)
        figure.legend(handles=lines, loc="outside lower center", ncols=columns, handlelength=1.4)


def _load_handles(loads: Array, colours: Sequence[tuple[float, ...]], unit: str) -> list[Artist]:
    from matplotlib.patches import Patch

    # The legend of a long path lists only some of the steps.
    every = -(-len(loads) // MAX_LEGEND_ENTRIES)
    chosen = sorted({*range(0, len(loads), every), len(loads) - 1})
    return [
        Patch(
            facecolor=colours[i],
            edgecolor=LINE,
            linewidth=0.5,
            label=f"{loads[i]:.4g} {unit}".rstrip(),
        )
        for i in chosen
    ]


def line_handles(scenes: Sequence[Scene]) -> list[Artist]:
    """Return the entries of a legend for the lines and marks of scenes."""
    from matplotlib.lines import Line2D

    lines = {line.label: line.colour for scene in scenes for line in scene.lines if line.label}
    marks = {mark.label: mark for scene in scenes for mark in scene.marks}
    return [
        *(Line2D([], [], color=colour, label=label) for label, colour in lines.items()),
        *(
            Line2D(
                [],
                [],
                marker=mark.symbol,
                linestyle="",
                label=label,
                **MARK | mark.style,
            )
            for label, mark in marks.items()
        ),
    ]
