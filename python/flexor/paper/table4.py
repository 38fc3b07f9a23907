"""Table IV: three objectives, one of them in two readings, on length and radii."""

from __future__ import annotations

from math import degrees

import numpy as np

from flexor.paper import published
from flexor.paper.context import Context
from flexor.paper.folder import Data
from flexor.paper.optimum import Optimum, evaluated, true_optimum
from flexor.paper.section import Column, Compared, Section, Table, number
from flexor.paper.settings import OBJECTIVES

PARAMETERS = "L+R01"
SYMBOLS = {
    "bending": "f_b",
    "tip-force": "f_exo",
    "bending-contact": "f_bc",
    "bending-contact-printed": "f_bc as printed",
}


def table4(context: Context) -> Section:
    """Find the optimum of L+R01 for every objective.

    Parameters
    ----------
    context : Context
        Models, settings and folder.

    Returns
    -------
    Section
        Table IV.
    """
    best = {name: true_optimum(context, PARAMETERS, name) for name in OBJECTIVES}
    theirs = {name: published_for(context, name) for name in OBJECTIVES}
    return Section(
        name="table4",
        title="Table IV: three objectives on L+R01",
        text=_text(best),
        compared=_compared(best),
        tables=(_table(best, theirs),),
    )


def published_for(context: Context, objective: str) -> Data:
    """Return what our model makes of the published optimum for an objective."""
    printed = published.TABLE_IV[of_table_iv(objective)]

    def compute() -> Data:
        return evaluated(context.problem(PARAMETERS, objective), np.array(printed.design))

    return context.part(f"published-{PARAMETERS}-{objective}", compute).data


def of_table_iv(objective: str) -> str:
    """Return the line of Table IV for an objective: both readings of f_bc have the same."""
    return objective.removesuffix("-printed")


def _text(best: dict[str, Optimum]) -> tuple[str, ...]:
    said = {
        name: f"L = {100 * found.design[0]:.1f} cm, R_0 = {100 * found.design[1]:.2f} cm, "
        f"R_1 = {100 * found.design[2]:.2f} cm, bending {found.bending:.2f} rad, tip force "
        f"{found.tip_force:.2f} N, spheres touching: {found.touching}"
        for name, found in best.items()
    }
    return (
        *(f"{SYMBOLS[name]}: {said[name]}." for name in OBJECTIVES),
        "The printed f_bc is the norm of [π - θ, -n_c], which grows with the number n_c of "
        "touching spheres, so minimising it avoids contact, against its purpose. f_bc without "
        "further words means the reading of the text: what is missing of contact, "
        "π (1 - n_c / N) with N the spheres of the exosuit, stands beside what is missing of "
        "bending.",
    )


def _compared(best: dict[str, Optimum]) -> tuple[Compared, ...]:
    rows = []
    for name in OBJECTIVES:
        printed = published.TABLE_IV[of_table_iv(name)]
        for label, theirs, ours in zip(
            ("L", "R_0", "R_1"), printed.design, best[name].design.tolist(), strict=True
        ):
            rows.append(
                Compared(
                    f"optimum for {SYMBOLS[name]}: {label}",
                    printed.place,
                    100.0 * theirs,
                    100.0 * ours,
                    "cm",
                )
            )
    return tuple(rows)


def _table(best: dict[str, Optimum], theirs: dict[str, Data]) -> Table:
    return Table(
        name="table4",
        caption="The optimum of L+R01 for each objective at 5 N, and what the published optimum "
        "gives in our model.",
        columns=(
            Column("objective"),
            Column("L", "cm", 3),
            Column("R_0", "cm", 3),
            Column("R_1", "cm", 3),
            Column("objective's value", digits=5),
            Column("bending", "rad"),
            Column("bending", "°", 3),
            Column("tip force", "N", 3),
            Column("spheres touching"),
            Column("evaluations"),
            Column("time", "s", 2, timing=True),
            Column("published design"),
            Column("its value", digits=5),
            Column("its bending", "rad"),
            Column("published time", "min", 3),
        ),
        rows=tuple(
            (
                SYMBOLS[name],
                *(100.0 * float(value) for value in best[name].design),
                best[name].value,
                best[name].bending,
                degrees(best[name].bending),
                best[name].tip_force,
                best[name].touching,
                best[name].evaluations,
                best[name].seconds,
                ", ".join(
                    number(100.0 * value, 3)
                    for value in published.TABLE_IV[of_table_iv(name)].design
                )
                + " cm",
                float(theirs[name]["value"]),
                float(theirs[name]["bending"]),
                published.TABLE_IV[of_table_iv(name)].minutes,
            )
            for name in OBJECTIVES
        ),
    )
