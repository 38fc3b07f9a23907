"""Figures of panels to one scale, each with scenes one over the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from flexor.plot.planar import draw_scene, frame_axes, height
from flexor.plot.scene import Scene
from flexor.plot.style import CHAMBER, PAGE, style

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

MARGINS = 0.62  # in, beside the axes: labels of the leftmost column
TITLE, TITLE_LINE = 0.16, 0.14  # in, above each row of axes, and for each line of a title
LEGEND = 0.62  # in, above all axes, and the numbers and label below them
TICKS = 5.0  # cm, alike on both axes


@dataclass(frozen=True)
class Layer:
    """A scene and how it is drawn.

    Attributes
    ----------
    scene : Scene
        What is drawn.
    colour : colour
        Of its rods.
    opacity : float
        Of its fills.
    """

    scene: Scene
    colour: Any
    opacity: float = 1.0


@dataclass(frozen=True)
class Panel:
    """One panel: layers from below to above.

    Attributes
    ----------
    title : str
        Above it.
    layers : list of Layer
        What is drawn, the last on top.
    """

    title: str
    layers: list[Layer] = field(default_factory=list)


def chamber_handle(scene: Scene, label: str | None = None) -> Artist:
    """Return the legend's entry for the chamber of a scene, by its own label or another."""
    from matplotlib.lines import Line2D

    return Line2D([], [], color=CHAMBER, label=label or scene.lines[0].label)


def draw_panels(panels: Sequence[Panel], columns: int, handles: Sequence[Artist]) -> Figure:
    """Draw panels side by side and below each other, all to one scale.

    Parameters
    ----------
    panels : sequence of Panel
        Row by row.
    columns : int
        In each row.
    handles : sequence of artists
        Entries of the legend.

    Returns
    -------
    matplotlib.figure.Figure
        As wide as a page.
    """
    from matplotlib.figure import Figure
    from matplotlib.ticker import MultipleLocator

    scenes = [layer.scene for panel in panels for layer in panel.layers]
    rows = -(-len(panels) // columns)
    with style():
        figure = Figure(figsize=(PAGE, PAGE), layout="constrained")
        grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        for axes, panel in zip(grid.flat, panels, strict=False):
            frame_axes(axes, scenes)
            for axis in (axes.xaxis, axes.yaxis):
                axis.set_major_locator(MultipleLocator(TICKS))
            axes.set_title(panel.title)
            for depth, layer in enumerate(panel.layers):
                draw_scene(
                    axes,
                    layer.scene,
                    colour=layer.colour,
                    opacity=layer.opacity,
                    depth=2.0 + depth,
                )
            axes.label_outer()
        for axes in grid.flat[len(panels) :]:
            axes.set_visible(False)
        one = height(grid.flat[0], (PAGE - MARGINS) / columns - 0.15)
        lines = 1 + max(panel.title.count("\n") for panel in panels)
        figure.set_figheight(rows * (one + TITLE + lines * TITLE_LINE) + LEGEND)
        figure.legend(
            handles=list(handles), loc="outside upper center", ncols=min(len(handles), 7),
            handlelength=1.2, columnspacing=1.4,
        )  # fmt: skip
    return figure
