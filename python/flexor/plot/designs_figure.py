"""Figure of designs side by side, before and after actuation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from flexor.plot import planar, spatial
from flexor.plot.path_figure import line_handles
from flexor.plot.scene import Scene, arrow_scale
from flexor.plot.style import EXOSUIT, LINE, PAGE, style

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

AT_REST = "#CBD2D8"


@dataclass(frozen=True)
class Design:
    """One panel of the figure."""

    title: str
    first: Scene  # at the first load
    last: Scene
    first_load: str
    last_load: str
    bending: float | None  # sum of the joint angles at the last load [rad]; None without joints


def draw_designs(designs: Sequence[Design], *, planar_model: bool) -> Figure:
    """Draw designs side by side to the same scale, each before and after actuation."""
    from matplotlib.figure import Figure

    scenes = [scene for design in designs for scene in (design.first, design.last)]
    cm_per_newton, key = arrow_scale([design.last for design in designs])
    with style():
        figure = Figure(figsize=(PAGE, 0.52 * PAGE), layout="constrained")
        for column, design in enumerate(designs, start=1):
            if planar_model:
                axes = figure.add_subplot(1, len(designs), column)
                planar.frame_axes(axes, scenes, with_key=key > 0.0)
                figure.set_figheight(planar.height(axes, PAGE / len(designs) - 0.6) + 1.0)
                planar.draw_scene(axes, design.first, colour=AT_REST, opacity=0.5, depth=2.0)
                planar.draw_scene(axes, design.last, colour=EXOSUIT, depth=4.0)
                planar.draw_contact_forces(axes, design.last, cm_per_newton=cm_per_newton)
                if key and column == 1:
                    planar.draw_key(axes, cm_per_newton=cm_per_newton, force=key)
            else:
                axes = figure.add_subplot(
                    1, len(designs), column, projection="3d", computed_zorder=False
                )
                spatial.frame_axes(axes, scenes)
                spatial.draw_scene(axes, design.first, colour=AT_REST, opacity=0.5)
                spatial.draw_scene(axes, design.last, colour=EXOSUIT)
                spatial.draw_contact_forces(axes, design.last, cm_per_newton=cm_per_newton)
            axes.set_title(_title(design))
        figure.legend(
            handles=_handles(designs), loc="outside upper center", ncols=4, handlelength=1.2
        )
    return figure


def _title(design: Design) -> str:
    if design.bending is None:
        return design.title
    degrees = math.degrees(design.bending)
    return f"{design.title}: bends {degrees:.0f}° ({design.bending:.2f} rad)"


def _handles(designs: Sequence[Design]) -> list[Artist]:
    from matplotlib.patches import Patch

    first = ", ".join(dict.fromkeys(design.first_load for design in designs))
    last = ", ".join(dict.fromkeys(design.last_load for design in designs))
    return [
        Patch(facecolor=AT_REST, edgecolor=LINE, linewidth=0.5, label=f"exosuit at {first}"),
        Patch(facecolor=EXOSUIT, edgecolor=LINE, linewidth=0.5, label=f"at {last}"),
        *line_handles([design.last for design in designs]),
    ]
