"""The searches of Fig. 4: least squares and pattern search from seeded random starts."""

from __future__ import annotations

import numpy as np

from flexor.optimizers import starting_designs
from flexor.paper import published
from flexor.paper.context import Context
from flexor.paper.folder import Data, Part
from flexor.paper.section import Cell, Column, Table
from flexor.study import Study, optimize

STARTS = {
    "levenberg-marquardt": published.LEAST_SQUARES_STARTS,
    "pattern-search": published.PATTERN_SEARCH_STARTS,
}
LETTERS = {"levenberg-marquardt": "L", "pattern-search": "P"}
NAMES = {"levenberg-marquardt": "Levenberg-Marquardt", "pattern-search": "pattern search"}


def searches_on_landscape(context: Context) -> Part:
    """Run both methods from seeded random starts on R01.

    Returns
    -------
    Part
        By method, a list of searches: every improvement (``designs``, ``values``,
        ``evaluations``), ``spent`` evaluations, ``snaps`` of the end point, and ``reason``.
    """
    problem = context.problem("R01")
    chosen = problem.parameters

    def compute() -> Data:
        random = np.random.default_rng(context.settings.seed)
        data: Data = {}
        for method, count in STARTS.items():
            # One hypercube for each method, so that its starts are spread over the range.
            starts = starting_designs(None, count, chosen.lower, chosen.upper, random)
            data[method] = []
            for i, start in enumerate(starts):
                context.say(f"{NAMES[method]}, start {i + 1} of {count}")
                study = optimize(
                    problem.model, chosen, "bending", method, start=start,
                    seed=context.settings.seed,
                    budget=context.settings.search,
                    executor=context.executor,
                )  # fmt: skip
                data[method].append(_described(study))
        return data

    return context.part("fig4-searches", compute)


def _described(study: Study) -> Data:
    result = study.result
    assert result is not None
    return {
        "designs": result.improvement_designs.tolist(),
        "values": result.improvement_values.tolist(),
        "evaluations": result.improvement_evaluations.tolist(),
        "spent": result.evaluations,
        "snaps": study.best.events,
        "reason": result.reason,
    }


def searches_table(searches: Data, reached: float) -> Table:
    """Return the table of the searches.

    Parameters
    ----------
    searches : dict
        What `searches_on_landscape` gave.
    reached : float
        The f_b from which on a search has found the minimum.
    """
    rows: list[tuple[Cell, ...]] = []
    for method in STARTS:
        for i, run in enumerate(searches[method]):
            first, last = run["designs"][0], run["designs"][-1]
            rows.append(
                (
                    f"{LETTERS[method]}_{i + 1}",
                    NAMES[method],
                    *(100.0 * value for value in first),
                    run["values"][0],
                    *(100.0 * value for value in last),
                    run["values"][-1],
                    run["spent"],
                    run["values"][-1] <= reached,
                )
            )
    return Table(
        name="fig4-searches",
        caption="Where each search of Fig. 4 began and ended.",
        columns=(
            Column("search"),
            Column("method"),
            Column("start R_0", "cm", 3),
            Column("start R_1", "cm", 3),
            Column("start f_b", "rad"),
            Column("end R_0", "cm", 3),
            Column("end R_1", "cm", 3),
            Column("end f_b", "rad"),
            Column("evaluations"),
            Column("found the minimum"),
        ),
        rows=tuple(rows),
    )
