"""Figure of designs side by side, before and after actuation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from flexor.plot import planar, spatial
from flexor.plot.legend import fitting_legend
from flexor.plot.path_figure import line_handles
from flexor.plot.scene import Scene, arrow_scale, pressure_scale
from flexor.plot.solid import draw_solid, largest_pressure, solid_colours
from flexor.plot.style import CHAMBER, EXOSUIT, FORCE, LINE, PAGE, literal, own_name, style

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

    from flexor.scene import Scene as SolidScene

AT_REST = "#8A949C"


@dataclass(frozen=True)
class Design:
    """One panel of the figure."""

    title: str
    first: Scene  # at the first load
    last: Scene
    first_load: str
    last_load: str
    bending: float | None  # sum of the joint angles at the last load [rad]; None without joints
    limbs: int = 1  # number of chains of joints, over which that is the sum
    solid: SolidScene | None = None  # of a spatial model, with its sections


LINE_HEIGHT = 0.18  # of titles [in]


def draw_designs(designs: Sequence[Design], *, planar_model: bool) -> Figure:
    """Draw designs side by side to the same scale, each before and after actuation."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    scenes = [scene for design in designs for scene in (design.first, design.last)]
    cm_per_newton, key = arrow_scale([design.last for design in designs])
    pressures = pressure_scale([design.last for design in designs])
    solids = [design.solid for design in designs if design.solid is not None]
    materials, pressure = solid_colours(solids), largest_pressure(solids)
    with style():
        # The layout does not see labels of z axes, which are right of the axes.
        layout = ConstrainedLayoutEngine(rect=(0.0, 0.0, 1.0 if planar_model else 0.97, 1.0))
        figure = Figure(figsize=(PAGE, 0.52 * PAGE), layout=layout)
        for column, design in enumerate(designs, start=1):
            if planar_model:
                axes = figure.add_subplot(1, len(designs), column)
                planar.frame_axes(axes, scenes, keys=(key > 0.0) + (pressures[1] > 0.0))
                above = 1.0 + LINE_HEIGHT * max(each.title.count("\n") for each in designs)
                figure.set_figheight(planar.height(axes, PAGE / len(designs) - 0.6) + above)
                planar.draw_scene(axes, design.last, colour=EXOSUIT, depth=4.0, sections=True)
                planar.draw_outlines(axes, design.first, colour=AT_REST, depth=6.0)
                planar.draw_pressure(axes, design.last, cm_per_pascal=pressures[0])
                planar.draw_contact_forces(axes, design.last, cm_per_newton=cm_per_newton)
                if column == 1:
                    planar.draw_keys(axes, (cm_per_newton, key), pressures, design.last.gravity)
            else:
                axes = figure.add_subplot(
                    1, len(designs), column, projection="3d", computed_zorder=False
                )
                spatial.frame_axes(axes, scenes)
                at_rest = replace(design.first, lines=[])
                spatial.draw_scene(axes, at_rest, colour=AT_REST, opacity=0.25)
                if design.solid is None:
                    spatial.draw_scene(axes, design.last, colour=EXOSUIT)
                else:
                    draw_solid(axes, design.solid, -1, materials, pressure)
                    # Cables and chambers within a rod, over it.
                    within = [each for each in design.last.lines if each.colour == CHAMBER]
                    spatial.draw_scene(axes, Scene(lines=within))
                spatial.draw_contact_forces(axes, design.last, cm_per_newton=cm_per_newton)
            axes.set_title(_title(design))
        handles = _handles(designs, planar_model)
        fitting_legend(figure, handles, "outside upper center", 6, handlelength=1.2)
    return figure


def _title(design: Design) -> str:
    if design.bending is None:
        return design.title
    degrees = math.degrees(design.bending)
    if design.limbs > 1:
        return f"{design.title}: bends {degrees:.0f}° in all ({design.limbs} limbs)"
    return f"{design.title}: bends {degrees:.0f}° ({design.bending:.2f} rad)"


def _handles(designs: Sequence[Design], planar_model: bool) -> list[Artist]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    first = "; ".join(dict.fromkeys(design.first_load for design in designs))
    last = "; ".join(dict.fromkeys(design.last_load for design in designs))
    scenes = [design.last for design in designs]
    edge: dict[str, Any] = {"edgecolor": LINE, "linewidth": 0.5}
    at_rest: Artist = Patch(facecolor=AT_REST, **edge, label=f"exosuit at {first}")
    solids = [design.solid for design in designs if design.solid is not None]
    materials = planar.material_colours(scenes) if planar_model else solid_colours(solids)
    if planar_model:
        at_rest = Line2D([], [], color=AT_REST, linewidth=0.7, label=f"at {first}")
    if not materials:
        shown = [Patch(facecolor=EXOSUIT, **edge, label=f"at {last}")]
    else:
        colours = {literal(own_name(name)): colour for name, colour in materials.items()}
        shown = [
            Patch(facecolor=colour, **edge, label=label if i else f"{label}, at {last}")
            for i, (label, colour) in enumerate(colours.items())
        ]
    pressure = largest_pressure(solids)
    if pressure > 0.0:
        label = f"contact pressure {pressure / 1e3:.3g} kPa"
        shown.append(Patch(facecolor=FORCE, **edge, label=label))
    return [at_rest, *shown, *line_handles(scenes)]
