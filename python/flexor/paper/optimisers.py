"""The comparison of optimisers that the paper mentions and does not show."""

from __future__ import annotations

import shutil
from collections.abc import Mapping

import numpy as np

from flexor.optimizers import available, entries
from flexor.paper.context import Context
from flexor.paper.folder import Data
from flexor.paper.optimum import true_optimum
from flexor.paper.section import Cell, Column, Picture, Section, Table
from flexor.paper.settings import COMPARED_METHODS, SETS
from flexor.study.comparison import (
    ComparisonProgress,
    MethodComparison,
    compare,
    resume_comparison,
)

SETTINGS = "settings.json"


def optimisers(context: Context) -> Section:
    """Compare methods on every set from the same starts, seeds and budget.

    Parameters
    ----------
    context : Context
        Models, settings and folder.

    Returns
    -------
    Section
        The comparison.
    """
    comparison = method_comparison(context)
    from flexor import plot

    return Section(
        name="optimisers",
        title="Which optimiser: the comparison the paper only mentions",
        text=_text(comparison),
        tables=(_success_table(comparison), _summary_table(comparison)),
        pictures=(
            Picture(
                "optimisers",
                "Performance profile (part of the problems solved within a multiple of the "
                "fastest method's evaluations) and data profile (part solved within a budget in "
                "groups of k + 1 evaluations, k the parameters of the set).",
                plot.profiles(comparison),
            ),
        ),
    )


def method_comparison(context: Context) -> MethodComparison:
    """Return the comparison on all sets, measured against the true optima."""
    settings = context.settings
    known = {name: true_optimum(context, name).value for name in SETS}
    place, _ = context.folder.study("comparison")

    def tell(at: ComparisonProgress) -> None:
        context.say(f"search {at.done:,} of {at.total:,}", at.done / max(at.total, 1))

    def compute() -> Data:
        begun = (place / SETTINGS).is_file()
        if not begun:
            # Killed while it was being made.
            shutil.rmtree(place, ignore_errors=True)
        compare(
            context.model(),
            SETS,
            "bending",
            methods=methods(),
            seeds=range(settings.seed, settings.seed + settings.compared_seeds),
            budget=settings.compared_budget,
            folder=place,
            resume=begun,
            progress=tell,
            executor=context.executor,
        )
        return {"methods": list(methods()), "missing": list(missing())}

    context.part("comparison", compute)
    return resume_comparison(place, known=known)


def methods() -> tuple[str, ...]:
    """Names of the methods that are compared: those of our list that are installed."""
    return tuple(name for name in COMPARED_METHODS if name in available())


def missing() -> tuple[str, ...]:
    """Names of the methods of our list that are not installed."""
    return tuple(name for name in COMPARED_METHODS if name not in available())


def title(method: str) -> str:
    """Return the name of a method as people read it."""
    return entries()[method].title if method in entries() else method


def success_rates(comparison: MethodComparison) -> Mapping[str, float]:
    """Part of all searches of each method that reached 99 % of the best known gain."""
    return {
        method: float(np.mean([comparison.summary(name, method).success for name in SETS]))
        for method in comparison.methods
    }


def _text(comparison: MethodComparison) -> tuple[str, ...]:
    rates = success_rates(comparison)
    order = sorted(rates, key=lambda method: -rates[method])
    said = ", ".join(f"{title(method)} {100.0 * rates[method]:.0f} %" for method in order)
    absent = [title(name) for name in COMPARED_METHODS if name not in comparison.methods]
    text = [
        f"Each method had {comparison.budget} evaluations from each of {len(comparison.seeds)} "
        f"random starts on each of {len(comparison.sets)} sets, "
        f"{len(comparison.runs):,} searches in all. A search succeeds if it has 99 % of the gain "
        "of the best design known, over the default design. Success over all sets: "
        f"{said}.",
    ]
    if "levenberg-marquardt" in comparison.methods:
        text.append(
            "Levenberg-Marquardt is the only one that uses derivatives. They are exact, come with "
            "each design from one more linear solve, and are not counted as evaluations."
        )
    if absent:
        text.append(f"Not installed where this was run, and so not compared: {', '.join(absent)}.")
    return tuple(text)


def _success_table(comparison: MethodComparison) -> Table:
    rates = success_rates(comparison)
    rows: list[tuple[Cell, ...]] = []
    for method in comparison.methods:
        summaries = [comparison.summary(name, method) for name in SETS]
        rows.append(
            (
                title(method),
                *(round(100.0 * summary.success) for summary in summaries),
                100.0 * rates[method],
            )
        )
    return Table(
        name="optimisers-success",
        caption="Searches that succeed [%], by method and set.",
        columns=(
            Column("method"),
            *(Column(name, "%") for name in SETS),
            Column("all", "%", 3),
        ),
        rows=tuple(rows),
    )


def _summary_table(comparison: MethodComparison) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for name in SETS:
        for method in comparison.methods:
            found = comparison.summary(name, method)
            rows.append(
                (
                    name,
                    title(method),
                    found.best,
                    found.median,
                    found.worst,
                    round(100.0 * found.success),
                    found.evaluations if np.isfinite(found.evaluations) else None,
                    found.expected_evaluations if np.isfinite(found.expected_evaluations) else None,
                    found.spent,
                    found.seconds,
                )
            )
    return Table(
        name="optimisers",
        caption="What the searches of each method on each set came to. Evaluations to 1 %: median "
        "of those that succeeded; expected: to the first success if begun anew after failures.",
        columns=(
            Column("set"),
            Column("method"),
            Column("best f_b", "rad", 5),
            Column("median f_b", "rad", 5),
            Column("worst f_b", "rad", 5),
            Column("success", "%"),
            Column("evaluations to 1 %", digits=3),
            Column("expected", digits=3),
            Column("spent", digits=3),
            Column("time", "s", 2, timing=True),
        ),
        rows=tuple(rows),
        brief=False,
    )
