"""A search that spares nothing, for true optima of rough landscapes."""

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

# Probability that a parameter of a random design is put on its lower or on its upper bound.
ON_BOUND = 0.15
# Of the best designs, how many are varied, and the probabilities that a variation keeps a
# parameter that is on a bound and one that is not.
VARIED, KEEP_ON_BOUND, KEEP = 20, 0.8, 0.4
# Shares of the evaluations: looking everywhere, varying, descending, evolving, and from each of the
# best following edges and following the gradient; the rest refines the best.
EXPLORE, VARY, DESCEND, EVOLVE, FOLLOW, SLOPE = 0.2, 0.3, 0.15, 0.1, 0.04, 0.03
FOLLOWED = 3
BATCH = 256
# Designs closer than this in every parameter, as a fraction of its range, are alike.
APART, NEAR = 0.1, 0.02


@dataclass(frozen=True)
class Thorough(Method):
    """Looks everywhere, descends from the best places, evolves them, and refines.

    Where a finger snaps, its landscape breaks into islands, some of them small and on the bounds
    of the design space. Random designs therefore have each parameter on a bound now and then: so
    they fall on faces and edges, which uniform ones never do. From the best that are not alike
    follow a pattern search (many starts side by side), differential evolution, CMA-ES with small
    steps (which follows the edges of islands, where polls along the axes stall), quasi-Newton steps
    by the exact gradient (for the smooth ground of many parameters) and a last pattern search.

    Attributes
    ----------
    evaluations : int
        Designs that it evaluates at most.
    """

    gradients: ClassVar[bool] = True

    evaluations: int = 2000

    @property
    def name(self) -> str:
        """``"thorough"``."""
        return "thorough"

    def run(self, run: Run) -> str:
        """Run all stages."""
        random = np.random.default_rng(run.seed)
        known = Known(run)
        self._explore(run, known, random)
        self._vary(run, known, random)
        k, most = run.size, self.evaluations
        descents = max(4, int(DESCEND * most) // (30 * k))
        self._stage(
            run, known, PatternSearch(initial_mesh=0.1, tolerance=2e-3),
            known.best(descents, APART), DESCEND * most, "descending",
        )  # fmt: skip
        population = 40
        self._stage(
            run, known, DifferentialEvolution(population=population, patience=20),
            known.best(population, NEAR), EVOLVE * most, "evolving",
        )  # fmt: skip
        for start in known.best(FOLLOWED, NEAR):
            self._stage(
                run, known, CmaEs(step=0.01, restarts=0), start[None, :], FOLLOW * most, "following"
            )
        for start in known.best(FOLLOWED, NEAR):
            self._stage(
                run, known, MultistartBfgs(starts=1), start[None, :], SLOPE * most, "sloping"
            )
        self._stage(
            run, known, PatternSearch(initial_mesh=4e-3, largest_mesh=1e-2, tolerance=1e-8),
            known.best(1, NEAR), max(most - len(known), most // 10), "refining",
        )  # fmt: skip
        return f"{run.function.evaluations} evaluations in seven stages"

    def _explore(self, run: Run, known: Known, random: np.random.Generator) -> None:
        known(run.starts(1, random))
        count = int(EXPLORE * self.evaluations)
        zeros, ones = np.zeros(run.size), np.ones(run.size)
        points = _some_on_bounds(starting_designs(None, count, zeros, ones, random), random)
        for first in range(0, count, BATCH):
            known(points[first : first + BATCH])
            run.step("exploring")

    def _vary(self, run: Run, known: Known, random: np.random.Generator) -> None:
        """Draw some parameters of the best designs anew, rather those that are on no bound."""
        for _ in range(0, int(VARY * self.evaluations), BATCH):
            best = known.best(VARIED, NEAR)
            parents = best[random.integers(len(best), size=BATCH)]
            drawn = _some_on_bounds(random.uniform(size=parents.shape), random)
            on_bound = (parents <= 0.0) | (parents >= 1.0)
            kept = random.uniform(size=parents.shape) < np.where(on_bound, KEEP_ON_BOUND, KEEP)
            known(np.where(kept, parents, drawn))
            run.step("varying")

    def _stage(
        self, run: Run, known: Known, search: Search, start: FloatArray, share: float, doing: str
    ) -> None:
        def tell(_: Progress) -> None:
            run.step(doing)

        search.minimize(
            known,
            np.zeros(run.size),
            np.ones(run.size),
            start=start,
            seed=run.seed,
            budget=Budget(evaluations=max(int(share), 1)),
            progress=tell,
        )


def _some_on_bounds(points: FloatArray, random: np.random.Generator) -> FloatArray:
    side = random.uniform(size=points.shape)
    return np.where(side < ON_BOUND, 0.0, np.where(side > 1.0 - ON_BOUND, 1.0, points))


class Known:
    """Everything that the stages have evaluated so far, as a function of its own.

    Parameters
    ----------
    run : Run
        The run they share.
    """

    def __init__(self, run: Run) -> None:
        self._run = run
        self._values: dict[bytes, float] = {}

    def __len__(self) -> int:
        return len(self._values)

    def __call__(self, points: FloatArray) -> FloatArray:
        """Values (n,) of points (n, k) in the unit box."""
        found = self._run.values(points)
        for point, value in zip(points, found.tolist(), strict=True):
            self._values[point.tobytes()] = value
        return found

    def gradient(self, points: FloatArray) -> FloatArray | None:
        """Exact gradients (n, k) there; None if there are none."""
        return self._run.gradient(points)

    def best(self, count: int, apart: float) -> FloatArray:
        """Return the best points (m, k), at most ``count``, none two of them alike."""
        chosen: list[FloatArray] = []
        for key in sorted(self._values, key=lambda key: self._values[key]):
            point = np.frombuffer(key)
            if all(np.max(np.abs(point - other)) > apart for other in chosen):
                chosen.append(point)
                if len(chosen) == count:
                    break
        return np.array(chosen)
