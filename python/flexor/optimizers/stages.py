"""Stages that methods in several stages have in common: variation of the best, other methods."""

from __future__ import annotations

import numpy as np

from flexor.optimizers.interface import Budget, FloatArray, Progress, Search
from flexor.optimizers.known import Known
from flexor.optimizers.method import Run

# Probability that a parameter of a random design is set to its lower, or to its upper bound.
ON_BOUND = 0.15
# Number of the best designs that are varied, and the probabilities that a variation keeps a
# parameter on a bound and one inside.
VARIED, KEEP_ON_BOUND, KEEP = 20, 0.8, 0.4
# Least distance of two starts in some parameter, as a share of its range: of the first searches,
# and of those from the best that are known then.
FAR, NEAR = 0.1, 0.02


def some_on_bounds(points: FloatArray, random: np.random.Generator) -> FloatArray:
    """Return points (n, k) of the unit box with some parameters set to their bounds."""
    side = random.uniform(size=points.shape)
    return np.where(side < ON_BOUND, 0.0, np.where(side > 1.0 - ON_BOUND, 1.0, points))


def vary_best(run: Run, known: Known, count: int, batch: int) -> None:
    """Replace random parameters of the best designs, mainly those inside the bounds."""
    random = run.random
    for _ in range(0, count, batch):
        best = known.best(VARIED, NEAR)
        parents = best[random.integers(len(best), size=min(batch, count))]
        drawn = some_on_bounds(random.uniform(size=parents.shape), random)
        on_bound = (parents <= 0.0) | (parents >= 1.0)
        kept = random.uniform(size=parents.shape) < np.where(on_bound, KEEP_ON_BOUND, KEEP)
        known(np.where(kept, parents, drawn))
        run.step("variation")


def run_stage(
    run: Run, known: Known, search: Search, start: FloatArray, evaluations: float, stage: str
) -> None:
    """Run another method from points (n, k) with so many evaluations."""

    def report_progress(at: Progress) -> None:
        run.step(f"{stage}: {at.detail}", at.remaining)

    search.minimize(
        known,
        np.zeros(run.size),
        np.ones(run.size),
        start=start,
        seed=run.seed,
        budget=Budget(evaluations=max(int(evaluations), 1)),
        progress=report_progress,
    )
