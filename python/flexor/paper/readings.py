"""The other reading of the paper's 1.43 rad, and what it makes of Tables III and IV."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import degrees

import numpy as np

from flexor.paper import published
from flexor.paper.context import Context
from flexor.paper.default import default_design
from flexor.paper.designs_figure import draw_designs
from flexor.paper.fig5 import optimal_paths
from flexor.paper.optimum import Optimum, true_optimum
from flexor.paper.section import Cell, Column, Compared, Picture, Section, Table
from flexor.paper.settings import OBJECTIVES, SETS, other_reading
from flexor.paper.table3 import published_design, shown_design
from flexor.paper.table4 import PARAMETERS, SYMBOLS, of_table_iv, published_for

# Sets whose parameters are lengths: their optima can be compared in parts of the ranges.
MEASURED = ("L", "R01", "L+R01")


def readings(context: Context) -> Section:
    """Find the optima of every set and objective with the constants of the other reading.

    Parameters
    ----------
    context : Context
        Models, settings and folder.

    Returns
    -------
    Section
        The other reading.
    """
    both = (context, context.using(other_reading(context.settings.constants)))
    _, other = both
    sets = [{name: true_optimum(each, name) for name in SETS} for each in both]
    objectives = [
        {name: true_optimum(each, PARAMETERS, name) for name in OBJECTIVES} for each in both
    ]
    paths = optimal_paths(other)
    return Section(
        name="readings",
        title="The other reading of 1.43 rad",
        text=_text(both, sets, objectives),
        compared=tuple(_compared(other, sets[1], objectives[1])),
        tables=(_sets_table(both, sets), _objectives_table(both, objectives)),
        pictures=(
            Picture(
                "readings",
                f'With the constants "{other.settings.constants}": the default design and the '
                "optimal design of each parameter set, at rest and at 5 N, all to one scale.",
                draw_designs(
                    {
                        f"{name}: {float(path.joint_angles[-1].sum()):.2f} rad": path
                        for name, path in paths.items()
                    }
                ),
            ),
        ),
    )


def _text(
    both: tuple[Context, Context],
    sets: list[dict[str, Optimum]],
    objectives: list[dict[str, Optimum]],
) -> tuple[str, ...]:
    mine, other = (context.settings.constants for context in both)
    said = [published_design(context, "L+R01")["bending"] for context in both]
    best = sets[1]["L+R01"]
    apart = [
        _apart(context, found, asked)
        for context, found, asked in zip(both, sets, objectives, strict=True)
    ]
    default = default_design(both[1])["bending"]
    return (
        "The paper says that its best design, that of L+R01, bends the finger by "
        f"{published.LARGEST_BENDING.value} rad. Either the design it prints does so in the right "
        "model, or the right model's own best design does; the fits differ. The design it prints "
        f'bends {said[0]:.2f} rad with the constants "{mine}" and {said[1]:.2f} rad with '
        f'"{other}"; the best design found bends {sets[0]["L+R01"].bending:.2f} and '
        f"{best.bending:.2f} rad.",
        f'With "{other}" the default design bends {default:.2f} rad and the optimum of L+R01 lies '
        f"at {shown_design(both[1].problem('L+R01'), best.design)}. On average over the lengths "
        "and radii of Table III and Table IV, an optimum is "
        f'{apart[0]:.0f} % of the range of its parameter away from the published one with "{mine}" '
        f'and {apart[1]:.0f} % with "{other}".',
    )


def _apart(context: Context, sets: Mapping[str, Optimum], asked: Mapping[str, Optimum]) -> float:
    """Mean distance of our optima from the published ones, in % of the parameters' ranges."""
    pairs = [(sets[name], published.TABLE_III[name]) for name in MEASURED]
    pairs += [(asked[name], printed) for name, printed in published.TABLE_IV.items()]
    parts: list[float] = []
    for ours, theirs in pairs:
        chosen = context.problem(ours.parameters).parameters
        parts += (np.abs(ours.design - theirs.design) / (chosen.upper - chosen.lower)).tolist()
    return 100.0 * float(np.mean(parts))


def _compared(
    context: Context, sets: Mapping[str, Optimum], objectives: Mapping[str, Optimum]
) -> Iterator[Compared]:
    printed = published.LARGEST_BENDING
    yield Compared(
        "bending of our optimum of L+R01, 5 N",
        printed.place,
        printed.value,
        sets["L+R01"].bending,
        "rad",
    )
    pairs = [(f"optimum of {name}", sets[name], published.TABLE_III[name]) for name in MEASURED]
    pairs.insert(2, ("global minimum of R01", sets["R01"], published.GLOBAL_MINIMUM))
    pairs += [
        (f"optimum for {SYMBOLS[name]}", objectives[name], published.TABLE_IV[of_table_iv(name)])
        for name in OBJECTIVES
    ]
    for what, ours, theirs in pairs:
        labels = context.problem(ours.parameters).parameters.labels
        for label, value, its in zip(labels, ours.design.tolist(), theirs.design, strict=True):
            yield Compared(f"{what}: {label}", theirs.place, 100.0 * its, 100.0 * value, "cm")


def _sets_table(both: tuple[Context, Context], sets: list[dict[str, Optimum]]) -> Table:
    names = [context.settings.constants for context in both]
    rows: list[tuple[Cell, ...]] = []
    for parameters in SETS:
        problem = both[0].problem(parameters)
        rows.append(
            (
                parameters,
                shown_design(problem, published.TABLE_III[parameters].design),
                *(shown_design(problem, found[parameters].design) for found in sets),
                *(found[parameters].bending for found in sets),
                *(float(published_design(each, parameters)["bending"]) for each in both),
                sets[1][parameters].events,
                sets[1][parameters].evaluations,
                sets[1][parameters].seconds,
            )
        )
    return Table(
        name="readings-sets",
        caption="Table III with both sets of constants: the optima, how far they bend the finger, "
        "and how far the published designs do. Snaps, evaluations and time are of "
        f'"{names[1]}".',
        columns=(
            Column("set"),
            Column("published design"),
            *(Column(f"optimum, {name}") for name in names),
            *(Column(f"bending, {name}", "rad") for name in names),
            *(Column(f"published design bends, {name}", "rad") for name in names),
            Column("snaps"),
            Column("evaluations"),
            Column("time", "s", 2, timing=True),
        ),
        rows=tuple(rows),
    )


def _objectives_table(both: tuple[Context, Context], objectives: list[dict[str, Optimum]]) -> Table:
    names = [context.settings.constants for context in both]
    problem = both[0].problem(PARAMETERS)
    rows: list[tuple[Cell, ...]] = []
    for name in OBJECTIVES:
        rows.append(
            (
                SYMBOLS[name],
                shown_design(problem, published.TABLE_IV[of_table_iv(name)].design),
                *(shown_design(problem, found[name].design) for found in objectives),
                *(degrees(found[name].bending) for found in objectives),
                *(found[name].tip_force for found in objectives),
                *(found[name].touching for found in objectives),
                degrees(float(published_for(both[1], name)["bending"])),
            )
        )
    return Table(
        name="readings-objectives",
        caption="Table IV with both sets of constants.",
        columns=(
            Column("objective"),
            Column("published design"),
            *(Column(f"optimum, {name}") for name in names),
            *(Column(f"bending, {name}", "°", 3) for name in names),
            *(Column(f"tip force, {name}", "N", 3) for name in names),
            *(Column(f"spheres touching, {name}") for name in names),
            Column(f"published design bends, {names[1]}", "°", 3),
        ),
        rows=tuple(rows),
    )
