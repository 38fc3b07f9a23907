"""Table III: the optimum of every parameter set, published, searched as the paper did, and true."""

from __future__ import annotations

from math import degrees

import numpy as np

from flexor.paper import published
from flexor.paper.context import Context
from flexor.paper.default import default_design, target
from flexor.paper.folder import Data
from flexor.paper.optimum import Optimum, evaluated, true_optimum
from flexor.paper.pattern_search import paper_search
from flexor.paper.section import Cell, Column, Compared, Section, Table, number
from flexor.paper.settings import SETS
from flexor.study import Problem

# A set holds those on the left of it: its optimum cannot be worse than theirs.
NESTED = {
    "L+R01": ("L", "R01"),
    "L+Rsc": ("Rsc",),
    "L+RLP": ("L", "RLP"),
}


def table3(context: Context) -> Section:
    """Find the optimum of every set.

    Parameters
    ----------
    context : Context
        Models, settings and folder.

    Returns
    -------
    Section
        Table III.
    """
    default = default_design(context)
    theirs = {name: published_design(context, name) for name in SETS}
    searched = {name: paper_search(context, name) for name in SETS}
    best = {name: true_optimum(context, name) for name in SETS}
    return Section(
        name="table3",
        title="Table III: the optimum of every parameter set",
        text=_text(context, default, theirs, searched, best),
        compared=_compared(context, best, theirs),
        tables=(
            _bending_table(default, theirs, searched, best),
            _designs_table(context, searched, best),
        ),
    )


def published_design(context: Context, parameters: str) -> Data:
    """Return what our model makes of the published optimum of a set."""

    def compute() -> Data:
        problem = context.problem(parameters)
        return evaluated(problem, np.array(published.TABLE_III[parameters].design))

    return context.part(f"published-{parameters}", compute).data


def shown_design(problem: Problem, design: object, digits: int = 3) -> str:
    """Return a design as people read it, in the set's units."""
    chosen = problem.parameters
    # Beyond the third decimal lies what the search left undecided.
    values = np.round(np.asarray(design, dtype=np.float64) / chosen.scale, 3)
    words: list[str] = []
    for unit in dict.fromkeys(chosen.units):
        inside = ", ".join(
            number(float(value), digits)
            for value, its in zip(values, chosen.units, strict=True)
            if its == unit
        )
        words.append(inside if unit in ("1", "rad") else f"{inside} {unit}")
    return "; ".join(words)


def _text(
    context: Context,
    default: Data,
    theirs: dict[str, Data],
    searched: dict[str, Optimum],
    best: dict[str, Optimum],
) -> tuple[str, ...]:
    largest = max(SETS, key=lambda name: best[name].bending)
    nested = [
        (outer, inner)
        for outer, inners in NESTED.items()
        for inner in inners
        if best[outer].value > best[inner].value
    ]
    short = [name for name in SETS if searched[name].value > target(context, best[name].value)]
    order = ", ".join(
        f"{name} {best[name].bending:.2f}"
        for name in sorted(SETS, key=lambda name: -best[name].bending)
    )
    return (
        f"The default design bends the finger by {default['bending']:.2f} rad at 5 N, the "
        f"published optimum of L+R01 by {theirs['L+R01']['bending']:.2f} rad (published "
        f"{published.LARGEST_BENDING.value}). Our optima bend it by: {order} rad. The best set "
        f"is {largest}.",
        "Sets that hold others are at least as good as those, as they must be."
        if not nested
        else "Some sets are worse than sets they hold: "
        + ", ".join(f"{outer} than {inner}" for outer, inner in nested)
        + ", which is a failure of the search.",
        "One pattern search from the default design, the paper's way, misses the optimum by more "
        f"than 1 % of its gain on {', '.join(short)}."
        if short
        else "One pattern search from the default design, the paper's way, finds the optimum of "
        "every set to within 1 % of its gain.",
    )


def _compared(
    context: Context, best: dict[str, Optimum], theirs: dict[str, Data]
) -> tuple[Compared, ...]:
    place = published.LARGEST_BENDING.place
    bending = theirs["L+R01"]["bending"]
    rows = [
        Compared(
            "bending of the published optimum of L+R01, 5 N",
            place,
            published.LARGEST_BENDING.value,
            bending,
            "rad",
        ),
        Compared(
            "bending of the published optimum of L+R01, 5 N",
            published.LARGEST_BENDING_DEGREES.place,
            published.LARGEST_BENDING_DEGREES.value,
            degrees(bending),
            "°",
        ),
        Compared(
            "bending of our optimum of L+R01, 5 N",
            place,
            published.LARGEST_BENDING.value,
            best["L+R01"].bending,
            "rad",
        ),
    ]
    for name in SETS:
        chosen = context.problem(name).parameters
        rows += [
            Compared(
                f"optimum of {name}: {label}",
                published.TABLE_III[name].place,
                printed / scale,
                float(ours) / scale,
                "" if unit == "1" else unit,
            )
            for label, unit, scale, printed, ours in zip(
                chosen.labels,
                chosen.units,
                chosen.scale.tolist(),
                published.TABLE_III[name].design,
                best[name].design,
                strict=True,
            )
        ]
    return tuple(rows)


def _bending_table(
    default: Data, theirs: dict[str, Data], searched: dict[str, Optimum], best: dict[str, Optimum]
) -> Table:
    rows: list[tuple[Cell, ...]] = [
        ("default", default["value"], default["bending"], *[None] * 9),
    ]
    rows += [
        (
            name,
            best[name].value,
            best[name].bending,
            best[name].events,
            best[name].evaluations,
            best[name].seconds,
            searched[name].value,
            searched[name].bending,
            searched[name].evaluations,
            searched[name].seconds,
            float(theirs[name]["bending"]),
            published.TABLE_III[name].minutes,
        )
        for name in SETS
    ]
    return Table(
        name="table3",
        caption="Bending at 5 N: the true optimum as far as a thorough search can tell, the end of "
        "one pattern search from the default design as in the paper, and the paper's own optimum "
        "in our model.",
        columns=(
            Column("set"),
            Column("optimum: f_b", "rad", 5),
            Column("bending", "rad"),
            Column("snaps"),
            Column("evaluations"),
            Column("time", "s", 2, timing=True),
            Column("pattern search: f_b", "rad", 5),
            Column("bending", "rad"),
            Column("evaluations"),
            Column("time", "s", 2, timing=True),
            Column("published design: bending", "rad"),
            Column("published time", "min", 3),
        ),
        rows=tuple(rows),
    )


def _designs_table(
    context: Context, searched: dict[str, Optimum], best: dict[str, Optimum]
) -> Table:
    problems = {name: context.problem(name) for name in SETS}
    return Table(
        name="table3-designs",
        caption="The designs themselves, in the order and the units of Table II.",
        columns=(
            Column("set"),
            Column("published"),
            Column("pattern search"),
            Column("optimum"),
        ),
        rows=tuple(
            (
                name,
                shown_design(problems[name], published.TABLE_III[name].design),
                shown_design(problems[name], searched[name].design),
                shown_design(problems[name], best[name].design),
            )
            for name in SETS
        ),
    )
