"""What the printed constants do, taken literally: a finding."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.design import parameter_set
from flexor.paper import published
from flexor.paper.context import ALONE, FINGER, TWO_LINKS, Context
from flexor.paper.fig3 import FORCES, tip_angle
from flexor.paper.folder import Data
from flexor.paper.scenes_figure import Layer, Panel, chamber_handle, draw_panels
from flexor.paper.section import Column, Compared, Picture, Section, Table
from flexor.paper.settings import CALIBRATED, PRINTED, other_reading
from flexor.plot.reading import read_scene
from flexor.plot.style import LINE, shades

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexor.model import Model

UNIT_FORCES = np.arange(0.0, 5.1, 1.0)  # N


def constants(context: Context) -> Section:
    """Follow the paper's experiments with the constants as printed.

    Parameters
    ----------
    context : Context
        Models, settings and folder.

    Returns
    -------
    Section
        The printed constants.
    """
    chosen = context.settings.constants
    names = tuple(dict.fromkeys((PRINTED, chosen, other_reading(chosen))))
    found = {name: _found(context, name) for name in names}
    ours, printed = found[chosen], found[PRINTED]
    bent = "; ".join(
        f"{what} {printed[key]:.2f} (published {number.value})" for what, key, number in _angles()
    )
    text = [
        f"Read literally (E = {published.YOUNG_MODULUS.value / 1e3:g} kPa, the chamber on the "
        f"surface), a chamber force of 5 N curls the free exosuit through "
        f"{printed['turns_5']:.1f} turns and stretches it by "
        f"{100.0 * printed['strain_5']:.0f} %; at 10 N it is {printed['turns_10']:.1f} turns and "
        f"{100.0 * printed['strain_10']:.0f} %, beyond the 100 % below which the paper holds its "
        "linear law to be good. The paper's Fig. 3 shows nothing of the kind. The sums of angles "
        f"in rad become: {bent}.",
    ]
    if chosen != PRINTED:
        text.append(
            f'This report uses the constants "{chosen}", and in the section on the other reading '
            f'"{other_reading(chosen)}": with the former the free exosuit turns by '
            f"{ours['turns_5']:.2f} of a turn at 5 N. Both are fitted to the paper's three printed "
            f'angles, which therefore agree by construction: for "{CALIBRATED[0]}" the design '
            f'published as the optimum of L+R01 bends 1.43 rad, for "{CALIBRATED[1]}" the '
            "model's own optimum does. Every other number is a prediction. Three constants for "
            "three numbers is a fit and no proof."
        )
    return Section(
        name="constants",
        title="The printed constants, and the ones used here",
        text=tuple(text),
        compared=(
            *(
                Compared(number.what, number.place, number.value, ours[key])
                for key, number in _counts()
            ),
            *(
                Compared(
                    f"{what}, {name} constants", number.place, number.value, found[name][key], "rad"
                )
                for name in names
                for what, key, number in _angles()
            ),
        ),
        tables=(_constants_table(context, names), _table(found)),
        pictures=(
            Picture(
                "constants",
                "The free exosuit and the finger at 0 to 5 N in steps of 1 N, to scale: with the "
                "constants as printed and as calibrated in either reading.",
                _figure(context, names, found),
            ),
        ),
    )


def _found(context: Context, name: str) -> Data:
    return context.part(f"constants-{name}", lambda: _compute(context, name)).data


def _angles() -> tuple[tuple[str, str, published.Number], ...]:
    return (
        ("three links, 10 N", "three_links", published.THREE_LINKS),
        ("two links, 10 N", "two_links", published.TWO_LINKS),
        ("published optimum of L+R01, 5 N", "optimum", published.LARGEST_BENDING),
    )


def _counts() -> tuple[tuple[str, published.Number], ...]:
    return (
        ("dof", published.DEGREES_OF_FREEDOM),
        ("exosuit_spheres", published.EXOSUIT_SPHERES),
        ("finger_spheres", published.FINGER_SPHERES),
    )


def _compute(context: Context, name: str) -> Data:
    context.say(f"paths with the {name} constants")
    model = context.model(ALONE, name)
    path = model.equilibrium(FORCES)
    at_5 = model.equilibrium(UNIT_FORCES)
    finger = context.model(FINGER, name)
    design = np.array([published.TABLE_III["L+R01"].design])
    geometry = parameter_set("L+R01", finger.design).geometry(design, finger.design.points)
    two, three = (context.model(links, name).equilibrium(FORCES) for links in (TWO_LINKS, FINGER))
    spheres = {name: len(group) for name, group in three.spheres(0).items()}
    return {
        "dof": finger.engine.dof,
        "exosuit_spheres": spheres["exosuit"],
        "finger_spheres": spheres["finger"],
        "turns_5": tip_angle(at_5, -1) / (2.0 * pi),
        "turns_10": tip_angle(path, -1) / (2.0 * pi),
        "strain_5": _axial_strain(model, at_5.q[-1]),
        "strain_10": _axial_strain(model, path.q[-1]),
        "two_links": float(two.joint_angles[-1].sum()),
        "three_links": float(three.joint_angles[-1].sum()),
        "snaps": len(two.events) + len(three.events),
        "optimum": float(finger.equilibrium(UNIT_FORCES, design=geometry).joint_angles[-1].sum()),
    }


def _axial_strain(model: Model, q: Any) -> float:
    """Largest axial strain along the rod."""
    columns = [i for i, name in enumerate(model.engine.coordinates) if ".extend_x" in name]
    return float(np.max(q[columns]))


def _constants_table(context: Context, names: tuple[str, ...]) -> Table:
    rows = []
    for name in names:
        model = context.model(FINGER, name)
        rows.append(
            (
                name,
                float(model.slot("exosuit.young_modulus")[0]) / 1e3,
                float(model.slot("chamber.lever")[1]),
                float(model.slot("skin.stiffness")[0]),
            )
        )
    return Table(
        name="constants-values",
        caption="The sets of constants. The lever is the chamber's distance from the axis as a "
        "multiple of the radius S(X); 1 is on the surface.",
        columns=(
            Column("constants"),
            Column("Young's modulus", "kPa", 5),
            Column("chamber lever", "S", 5),
            Column("contact stiffness", "N/m"),
        ),
        rows=tuple(rows),
    )


def _table(found: dict[str, Data]) -> Table:
    return Table(
        name="constants",
        caption="What each set of constants gives.",
        columns=(
            Column("constants"),
            Column("free exosuit at 5 N", "turns", 3),
            Column("its largest strain", "%", 3),
            Column("at 10 N", "turns", 3),
            Column("its largest strain", "%", 3),
            Column("three links, 10 N", "rad"),
            Column("two links, 10 N", "rad"),
            Column("snaps on these two"),
            Column("published optimum of L+R01, 5 N", "rad"),
        ),
        rows=tuple(
            (
                name,
                data["turns_5"],
                100.0 * data["strain_5"],
                data["turns_10"],
                100.0 * data["strain_10"],
                data["three_links"],
                data["two_links"],
                int(data["snaps"]),
                data["optimum"],
            )
            for name, data in found.items()
        ),
    )


def _figure(context: Context, names: tuple[str, ...], found: dict[str, Data]) -> Figure:
    from matplotlib.patches import Patch

    colours = [tuple(shade) for shade in shades(len(UNIT_FORCES))]
    panels = []
    for body, what in ((ALONE, "exosuit alone"), (FINGER, "on the finger")):
        for name in names:
            path = context.model(body, name).equilibrium(UNIT_FORCES)
            said = (
                f"{found[name]['turns_5']:.2f} turns at 5 N"
                if body == ALONE
                else f"{float(path.joint_angles[-1].sum()):.2f} rad at 5 N"
            )
            layers = [
                Layer(read_scene(path, step), colour, 0.8)
                for step, colour in zip(range(len(path)), colours, strict=True)
            ]
            panels.append(Panel(f"{name}, {what}\n{said}", layers))
    handles = [
        Patch(facecolor=colour, edgecolor=LINE, linewidth=0.5, label=f"{force:g} N")
        for force, colour in zip(UNIT_FORCES, colours, strict=True)
    ]
    drawn = chamber_handle(panels[0].layers[0].scene, "chamber (drawn on the surface)")
    return draw_panels(panels, len(names), [*handles, drawn])
