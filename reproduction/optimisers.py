"""The comparison of optimisers that the paper mentions without showing it."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TYPE_CHECKING

import numpy as np

import flexor
from flexor.optimizers import available, entries
from flexor.study.comparison import ComparisonProgress
from reproduction.optima import optimum
from reproduction.study import SETS, Data, Study, model

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Bayesian optimisation is omitted: proposing one design takes longer than evaluating a hundred.
METHODS = (
    "levenberg-marquardt",
    "pattern-search",
    "genetic-algorithm",
    "differential-evolution",
    "particle-swarm",
    "cma-es",
    "direct",
    "mads",
)


def compute(study: Study) -> Data:
    """Compare methods on every set from the same starts, with the same seeds and budget."""
    comparison = _comparison(study)
    success = {
        method: {name: 100.0 * comparison.summary(name, method).success for name in SETS}
        for method in comparison.methods
    }
    return {
        "budget": comparison.budget,
        "seeds": len(comparison.seeds),
        "searches": len(comparison.runs),
        "title": {name: entries()[name].title if name in entries() else name for name in METHODS},
        "success": success,
        "overall": {
            method: float(np.mean(list(rates.values()))) for method, rates in success.items()
        },
        "missing": [name for name in METHODS if name not in comparison.methods],
    }


def draw(study: Study, data: Data) -> dict[str, Figure]:
    """Draw performance and data profiles."""
    from flexor import plot

    return {"optimisers": plot.profiles(_comparison(study))}


def _comparison(study: Study) -> flexor.MethodComparison:
    """Run or load the comparison, with the optima as best known designs."""
    folder, exists = study.subfolder("comparison")

    def progress(at: ComparisonProgress) -> None:
        study.report_progress(f"comparison of optimisers, search {at.done:,} of {at.total:,}")

    known = {name: optimum(study, name)["value"] for name in SETS}
    # Most of the time of a search is that of its method, in Python.
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        return flexor.compare(
            model(), SETS, "bending",
            methods=[name for name in METHODS if name in available()],
            seeds=range(study.seed, study.seed + study.effort.seeds),
            budget=study.effort.budget, known=known,
            folder=folder, resume=exists, progress=progress, executor=pool,
        )  # fmt: skip
