"""A global search in several stages, for landscapes with many local minima and discontinuities."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from flexor.optimizers import (
    CmaEs,
    DifferentialEvolution,
    Method,
    MultistartBfgs,
    PatternSearch,
    Run,
    starting_designs,
)
from flexor.optimizers.known import Known
from flexor.optimizers.stages import FAR, NEAR, run_stage, some_on_bounds, vary_best

# Fractions of the evaluations for sampling, variation, pattern search, differential evolution, and
# for CMA-ES and L-BFGS-B from each of the best; the rest is for the final pattern search.
EXPLORE, VARIATION, PATTERN, EVOLUTION, CMA, BFGS = 0.2, 0.3, 0.15, 0.1, 0.04, 0.03
BEST_STARTS = 3
BATCH = 256


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
        vary_best(run, known, int(VARIATION * self.evaluations), BATCH)
        k, most = run.size, self.evaluations
        starts = max(4, int(PATTERN * most) // (30 * k))
        run_stage(
            run, known, PatternSearch(initial_mesh=0.1, tolerance=2e-3),
            known.best(starts, FAR), PATTERN * most, "pattern search",
        )  # fmt: skip
        population = 40
        run_stage(
            run, known, DifferentialEvolution(population=population, patience=20),
            known.best(population, NEAR), EVOLUTION * most, "differential evolution",
        )  # fmt: skip
        for start in known.best(BEST_STARTS, NEAR):
            run_stage(
                run, known, CmaEs(step=0.01, restarts=0), start[None, :], CMA * most, "CMA-ES"
            )
        for start in known.best(BEST_STARTS, NEAR):
            run_stage(run, known, MultistartBfgs(starts=1), start[None, :], BFGS * most, "L-BFGS-B")
        run_stage(
            run, known, PatternSearch(initial_mesh=4e-3, largest_mesh=1e-2, tolerance=1e-8),
            known.best(1, NEAR), max(most - len(known), most // 10), "refinement",
        )  # fmt: skip
        return f"{run.function.evaluations} evaluations in seven stages"

    def _explore(self, run: Run, known: Known, random: np.random.Generator) -> None:
        known(run.starts(1))
        count = int(EXPLORE * self.evaluations)
        zeros, ones = np.zeros(run.size), np.ones(run.size)
        points = some_on_bounds(starting_designs(None, count, zeros, ones, random), random)
        for first in range(0, count, BATCH):
            known(points[first : first + BATCH])
            run.step("sampling")
