"""Fig. 5: the default and every optimal design, at 0 and 5 N."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING

from flexor.paper.context import Context
from flexor.paper.optimum import true_optimum
from flexor.paper.scenes_figure import Layer, Panel, draw_panels
from flexor.paper.section import Picture, Section
from flexor.paper.settings import SETS
from flexor.plot.reading import read_scene
from flexor.plot.style import CHAMBER, EXOSUIT, LINE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexor.model import Path

AT_REST = "#C3CBD2"


def fig5(context: Context) -> Section:
    """Draw the default and the optimal design of every set before and after actuation.

    Parameters
    ----------
    context : Context
        Models, settings and folder.

    Returns
    -------
    Section
        Fig. 5.
    """
    paths: dict[str, Path] = {"default": context.path(context.problem("L"), None)}
    for name in SETS:
        paths[name] = context.path(context.problem(name), true_optimum(context, name).design)
    bending = {name: float(path.joint_angles[-1].sum()) for name, path in paths.items()}
    most, default = max(SETS, key=lambda name: bending[name]), bending["default"]
    outdone = sum(bending[name] > default for name in SETS)
    return Section(
        name="fig5",
        title="Fig. 5: the optimal designs at 0 and 5 N",
        text=(
            f"{outdone} of {len(SETS)} optimal designs bend the finger further than the default "
            f"({degrees(default):.0f}°); furthest bends {most}, {degrees(bending[most]):.0f}°.",
        ),
        pictures=(
            Picture(
                "fig5",
                "The default design and the optimal design of each parameter set, at rest and at "
                "5 N, all to one scale.",
                _figure(paths, bending),
            ),
        ),
    )


def _figure(paths: dict[str, Path], bending: dict[str, float]) -> Figure:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    panels = [
        Panel(
            f"{name}: {bending[name]:.2f} rad",
            [
                Layer(read_scene(path, 0), AT_REST, 0.45),
                Layer(read_scene(path, -1), EXOSUIT, 0.95),
            ],
        )
        for name, path in paths.items()
    ]
    handles = [
        Patch(facecolor=AT_REST, edgecolor=LINE, linewidth=0.5, label="exosuit at 0 N"),
        Patch(facecolor=EXOSUIT, edgecolor=LINE, linewidth=0.5, label="at 5 N"),
        Line2D([], [], color=CHAMBER, label="chamber"),
    ]
    return draw_panels(panels, 4, handles)
