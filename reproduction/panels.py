"""Figures of panels with a common scale, each with overlaid scenes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MultipleLocator

from flexor.plot.planar import draw_scene, frame_axes, height
from flexor.plot.reading import read_scene
from flexor.plot.scene import Scene
from flexor.plot.style import CHAMBER, EXOSUIT, LINE, PAGE, shades, style

if TYPE_CHECKING:
    from matplotlib.artist import Artist

    import flexor

MARGINS = 0.62  # in, beside the axes: labels of the leftmost column
TITLE, TITLE_LINE = 0.16, 0.14  # in, above each row of axes, and for each line of a title
LEGEND = 0.62  # in, above all axes, and the numbers and label below them
TICKS = 5.0  # cm, on both axes
AT_REST = "#C3CBD2"
COLUMNS = 4


@dataclass(frozen=True)
class Layer:
    """A scene, the colour of its rods and the opacity of its fills."""

    scene: Scene
    colour: Any
    opacity: float = 1.0

    @classmethod
    def along(cls, path: flexor.Path, opacity: float, last: float | None = None) -> list[Layer]:
        """Return a layer for each step of a path, coloured by load; the last may be more opaque."""
        colours = [tuple(shade) for shade in shades(len(path))]
        layers = [cls(read_scene(path, i), colour, opacity) for i, colour in enumerate(colours)]
        return [*layers[:-1], cls(layers[-1].scene, colours[-1], last or opacity)]


@dataclass(frozen=True)
class Panel:
    """A title, and layers from bottom to top."""

    title: str
    layers: list[Layer]


def load_handles(forces: Iterable[float], chamber: str = "chamber") -> list[Artist]:
    """Return the legend of the loads [N] and of the chamber."""
    forces = list(forces)
    return [
        *(
            Patch(facecolor=tuple(colour), edgecolor=LINE, linewidth=0.5, label=f"{force:g} N")
            for force, colour in zip(forces, shades(len(forces)), strict=True)
        ),
        Line2D([], [], color=CHAMBER, label=chamber),
    ]


def draw_designs(paths: Mapping[str, flexor.Path], loaded: str | None = None) -> Figure:
    """Draw designs at rest and at their last load, one panel per title.

    ``loaded`` names that load, by default the force of the first design.
    """
    panels = [
        Panel(
            title,
            [
                Layer(read_scene(path, 0), AT_REST, 0.45),
                Layer(read_scene(path, -1), EXOSUIT, 0.95),
            ],
        )
        for title, path in paths.items()
    ]
    loaded = loaded or f"at {next(iter(paths.values())).force[-1]:g} N"
    handles = [
        Patch(facecolor=AT_REST, edgecolor=LINE, linewidth=0.5, label="exosuit at 0 N"),
        Patch(facecolor=EXOSUIT, edgecolor=LINE, linewidth=0.5, label=loaded),
        Line2D([], [], color=CHAMBER, label="chamber"),
    ]
    return draw_panels(panels, COLUMNS, handles)


def draw_panels(panels: Sequence[Panel], columns: int, handles: Sequence[Artist]) -> Figure:
    """Draw panels row by row, to a common scale, one page wide."""
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
                    axes, layer.scene, colour=layer.colour, opacity=layer.opacity,
                    depth=2.0 + depth,
                )  # fmt: skip
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
