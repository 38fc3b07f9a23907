"""A global search in several stages, for landscapes with many local minima and discontinuities."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from flexor.optimizers import (
    Budget,
    CmaEs,
    DifferentialEvolution,
    Method,
    MultistartBfgs,
    PatternSearch,
    Progress,
    Run,
    Search,
    starting_designs,
)
from flexor.optimizers.interface import FloatArray
from flexor.optimizers.known import Known

# Probability that a parameter of a random design is set to its lower, or to its upper bound.
ON_BOUND = 0.15
# Number of the best designs that are varied, and the probabilities that a variation keeps a
# parameter on a bound and one inside.
VARIED, KEEP_ON_BOUND, KEEP = 20, 0.8, 0.4
# Fractions of the evaluations for sampling, variation, pattern search, differential evolution, and
# for CMA-ES and L-BFGS-B from each of the best; the rest is for the final pattern search.
EXPLORE, VARIATION, PATTERN, EVOLUTION, CMA, BFGS = 0.2, 0.3, 0.15, 0.1, 0.04, 0.03
BEST_STARTS = 3
BATCH = 256
# Minimum distance of two starts in some parameter, as a fraction of its range: of the starts of the
# pattern search, and of the other stages.
FAR, NEAR = 0.1, 0.02


@dataclass(frozen=True)
class MultistageSearch(Method):
    """Global sampling, then local and population methods from the best designs, then refinement.

    Snaps divide the landscape into separate regions, some of them small and on the bounds of the
    design space. Random designs therefore have each parameter on a bound with some probability, so
    that faces and edges are sampled, too, which uniform random designs never hit. From the best
    distinct designs start a pattern search with many starts in parallel, differential evolution,
    CMA-ES with small steps (which follows discontinuities, where polls along the axes stall),
    L-BFGS-B with the exact gradient (for smooth regions with many parameters) and a final pattern
    search.

    Attributes
    ----------
    evaluations : int
        Maximum number of evaluations.
    """

    name: ClassVar[str] = "multistage"
    gradients: ClassVar[bool] = True

    evaluations: int = 2000

    def run(self, run: Run) -> str:
        """Run all stages."""
        random = run.random
        known = Known(run)
        self._explore(run, known, random)
        self._vary(run, known, random)
        k, most = run.size, self.evaluations
        starts = max(4, int(PATTERN * most) // (30 * k))
        self._stage(
            run, known, PatternSearch(initial_mesh=0.1, tolerance=2e-3),
            known.best(starts, FAR), PATTERN * most, "pattern search",
        )  # fmt: skip
        population = 40
        self._stage(
            run, known, DifferentialEvolution(population=population, patience=20),
            known.best(population, NEAR), EVOLUTION * most, "differential evolution",
        )  # fmt: skip
        for start in known.best(BEST_STARTS, NEAR):
            self._stage(
                run, known, CmaEs(step=0.01, restarts=0), start[None, :], CMA * most, "CMA-ES"
            )
        for start in known.best(BEST_STARTS, NEAR):
            self._stage(
                run, known, MultistartBfgs(starts=1), start[None, :], BFGS * most, "L-BFGS-B"
            )
        self._stage(
            run, known, PatternSearch(initial_mesh=4e-3, largest_mesh=1e-2, tolerance=1e-8),
            known.best(1, NEAR), max(most - len(known), most // 10), "refinement",
        )  # fmt: skip
        return f"{run.function.evaluations} evaluations in seven stages"

    def _explore(self, run: Run, known: Known, random: np.random.Generator) -> None:
        known(run.starts(1))
        count = int(EXPLORE * self.evaluations)
        zeros, ones = np.zeros(run.size), np.ones(run.size)
        points = _some_on_bounds(starting_designs(None, count, zeros, ones, random), random)
        for first in range(0, count, BATCH):
            known(points[first : first + BATCH])
            run.step("sampling")

    def _vary(self, run: Run, known: Known, random: np.random.Generator) -> None:
        """Replace random parameters of the best designs, mainly those inside the bounds."""
        for _ in range(0, int(VARIATION * self.evaluations), BATCH):
            best = known.best(VARIED, NEAR)
            parents = best[random.integers(len(best), size=BATCH)]
            drawn = _some_on_bounds(random.uniform(size=parents.shape), random)
            on_bound = (parents <= 0.0) | (parents >= 1.0)
            kept = random.uniform(size=parents.shape) < np.where(on_bound, KEEP_ON_BOUND, KEEP)
            known(np.where(kept, parents, drawn))
            run.step("variation")

    def _stage(
        self, run: Run, known: Known, search: Search, start: FloatArray, share: float, stage: str
    ) -> None:
        def report_progress(_: Progress) -> None:
            run.step(stage)

        search.minimize(
            known,
            np.zeros(run.size),
            np.ones(run.size),
            start=start,
            seed=run.seed,
            budget=Budget(evaluations=max(int(share), 1)),
            progress=report_progress,
        )


def _some_on_bounds(points: FloatArray, random: np.random.Generator) -> FloatArray:
    side = random.uniform(size=points.shape)
    return np.where(side < ON_BOUND, 0.0, np.where(side > 1.0 - ON_BOUND, 1.0, points))
