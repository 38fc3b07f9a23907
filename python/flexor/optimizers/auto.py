"""Global search in stages: sample, SQP, variation, pattern search, evolution, refinement."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from flexor.optimizers.cma_es import CmaEs
from flexor.optimizers.interface import FloatArray
from flexor.optimizers.known import Known
from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import FRACTION, at_least, at_most, option
from flexor.optimizers.pattern import PatternSearch
from flexor.optimizers.population import DifferentialEvolution
from flexor.optimizers.side_by_side import side_by_side
from flexor.optimizers.sqp import (
    Linearization,
    Linearize,
    linearization,
    linearizations,
    minimize_slsqp,
)
from flexor.optimizers.stages import FAR, NEAR, run_stage, some_on_bounds, vary_best

# Shares of the evaluations: of the sample, of SQP from it, and where that leaves doubt of
# variation, pattern search, differential evolution and, from each of the best, CMA-ES. The rest is
# for SQP from the best and the refinement.
SAMPLE, DESCENTS, VARIATION, PATTERN, EVOLUTION, CMA = 0.08, 0.3, 0.25, 0.12, 0.1, 0.03
BEST = 3
BATCH = 128
# SQP begins from so many of the best after so many designs of the sample per parameter and one
# more, so that a small budget is not spent on the sample alone.
EARLY, EARLY_BEST = 5, 2
# Local optima count as one if their values differ by less than this share of the sample's range.
SAME = 1e-3
# Steps of the refinement from a start that is nearly optimal, as a share of the ranges, below which
# SQP takes its place.
COARSE = 2e-3
# Searches by SQP side by side, whose designs are evaluated together.
AT_ONCE = 4
# Least number of searches after which the optima are all known, and after which they are too many:
# more than this share of the searches ended in a different one. Then one CMA-ES with this step, a
# share of the ranges, has the evaluations that are left.
LEAST, LEAST_MANY, MANY, STEP = 6, 5, 0.5, 0.2
# Below this share of the evaluations there is nothing left for further stages.
LITTLE = 0.1


class Optima(Enum):
    """What searches from the sample tell about the local optima."""

    ALL_KNOWN = "probably no others"
    MANY = "hardly any was found twice"
    UNKNOWN = "neither"


@dataclass(frozen=True)
class Auto(Method):
    """Sample, SLSQP (Kraft 1988) with the constraints, and global stages where these leave doubt.

    A Sobol sample of the box, its faces and edges is followed by SLSQP from its best designs, apart
    from each other, with the constraints. If so many searches found so few optima that probably
    there are no others (the stopping rule of Boender and Rinnooy Kan 1987), a pattern search
    refines the best, and that is the end. If more than half of them ended in different optima,
    further ones tell little, and one CMA-ES (Hansen) from the best goes on until it converges or
    the evaluations end. Where some are left, as where snaps divide the landscape, follow
    variations of the best designs, a pattern search with many starts in parallel, differential
    evolution, CMA-ES with small steps, which follows discontinuities where polls along the axes
    stall, SLSQP from the best, and the refinement. These stages see ranks: feasible designs before
    all others.

    Slopes of values and constraints are exact; where one of these has no derivative, they are
    one-sided differences, one batch for each.

    Attributes
    ----------
    evaluations : int
        Maximum number of evaluations, over which the stages are spread.
    explore : bool
        Whether to search the whole box; without, only SLSQP from the starts, which are nearly
        optimal, and a refinement of fewer designs.
    iterations : int
        Maximum number of iterations of each SLSQP.
    difference : float
        Step of the differences where there is no exact gradient, as a fraction of the ranges.
    mesh, tolerance : float
        Initial and final mesh size of the refinement, likewise.
    """

    name = "auto"
    title = "sample, SQP and global stages"
    description = "sample, SQP with constraints, and where these leave doubt global stages"
    packages = ("scipy", "pymoo", "cma")

    evaluations: int = option(3000, at_least(1))
    explore: bool = True
    iterations: int = option(30, at_least(1))
    difference: float = option(1e-5, at_most(0.1))
    mesh: float = option(0.02, FRACTION)
    tolerance: float = option(1e-4, FRACTION)

    @property
    def from_optimum(self) -> Auto:
        """The same from starts that are nearly optimal."""
        return replace(self, explore=False)

    def run(self, run: Run) -> str:
        """Run all stages that are needed."""
        # Nothing depends on the budget: with another one a search is resumed by replaying it.
        known, most = Known(run), self.evaluations
        starts = run.starts(0 if self.explore else 1)
        if len(starts):
            known(starts)
        if self.explore:
            sample = _sample(run, max(int(SAMPLE * most), 1))
            first = EARLY * (run.size + 1)
            known(sample[:first])
            run.step("sample")
            for start in known.best(EARLY_BEST, FAR):
                self._descend(run, known, start)
            known(sample[first:])
            run.step("sample")
        if not len(known.best(1, 0.0)):
            return "no design of the sample succeeded" if self.explore else "the start failed"
        if not self.explore:
            for start in known.best(BEST + 1, 0.0):
                self._descend(run, known, start)
            return self._refine(run, known, most)
        optima = self._descents(run, known, int(DESCENTS * most))
        if optima is Optima.UNKNOWN:
            self._explore(run, known, most)
        elif optima is Optima.MANY:
            left, best = most - run.function.evaluations, known.best(1, 0.0)
            run_stage(run, known, CmaEs(step=STEP, restarts=0), best, left, "CMA-ES")
            left = most - run.function.evaluations
            if left > LITTLE * most:
                self._explore(run, known, int(left / (1.0 - SAMPLE - DESCENTS)))
        return self._refine(run, known, most)

    def _explore(self, run: Run, known: Known, most: int) -> None:
        """Run the global stages with their shares of so many evaluations."""
        vary_best(run, known, int(VARIATION * most), BATCH)
        starting = max(4, int(PATTERN * most) // (30 * run.size))
        pattern = PatternSearch(initial_mesh=0.1, tolerance=2e-3)
        run_stage(run, known, pattern, known.best(starting, FAR), PATTERN * most, "pattern search")
        population = max(min(40, int(EVOLUTION * most) // 4), 5)
        run_stage(
            run, known, DifferentialEvolution(population=population, patience=20),
            known.best(population, NEAR), EVOLUTION * most, "differential evolution",
        )  # fmt: skip
        for start in known.best(BEST, NEAR):
            run_stage(
                run, known, CmaEs(step=0.01, restarts=0), start[None, :], CMA * most, "CMA-ES"
            )
        for start in known.best(BEST, NEAR):
            self._descend(run, known, start)

    def _descents(self, run: Run, known: Known, budget: int) -> Optima:
        """Run SLSQP from the best designs; return what their ends tell about the optima.

        After w different optima of n searches that ended in one they are probably all known if
        w (n - 1) / (n - w - 2), which estimates their number, is below w + ½.
        """
        begun, ends = run.function.evaluations, list[float]()
        values = run.values(known.best(len(known), 0.0))
        spread = float(np.ptp(values[np.isfinite(values)]))

        def starts() -> Iterator[FloatArray]:
            for start in known.best(len(known), FAR):
                if run.function.evaluations - begun >= budget:
                    return
                yield start

        def answers(points: list[FloatArray]) -> list[Linearization]:
            found = linearizations(run, points, self.difference)
            run.step("SQP")
            return found

        def descend(start: FloatArray, linearize: Linearize) -> FloatArray:
            return minimize_slsqp(start, linearize, self.iterations)

        with closing(side_by_side(descend, starts(), answers, AT_ONCE)) as searches:
            for end in searches:
                known(end[None, :])
                value, excess = run.constrained(end[None, :])
                # What ends where constraints do not hold is no optimum.
                if np.isfinite(value[0]) and not (excess > 0.0).any():
                    ends.append(float(value[0]))
                n, w = len(ends), _different(ends, SAME * spread)
                if n >= LEAST and n > w + 2 and w * (n - 1) / (n - w - 2) <= w + 0.5:
                    return Optima.ALL_KNOWN
                if n >= LEAST_MANY and w > MANY * n:
                    return Optima.MANY
        return Optima.UNKNOWN

    def _descend(self, run: Run, known: Known, start: FloatArray) -> FloatArray:
        """Run SLSQP from a point (k,); return where it ends (k,)."""
        end = minimize_slsqp(
            start,
            lambda point: linearization(run, point, self.difference),
            self.iterations,
            step=run.step,
        )
        known(end[None, :])
        return end

    def _refine(self, run: Run, known: Known, most: int) -> str:
        """Go on from the best design."""
        if not self.explore and run.linearized(known.best(1, 0.0)) is not None:
            return self._refine_coarsely(run, known, most)
        return self._refine_finely(run, known, most)

    def _refine_finely(self, run: Run, known: Known, most: int) -> str:
        """Run a pattern search."""
        share = max(most - run.function.evaluations, most // 10, 1)
        search = PatternSearch(initial_mesh=self.mesh, tolerance=self.tolerance)
        run_stage(run, known, search, known.best(1, 0.0), share, "refinement")
        run.function.check()
        return f"converged: no better design within {self.tolerance:g} of the ranges"

    def _refine_coarsely(self, run: Run, known: Known, most: int) -> str:
        """Poll all neighbours, which finds ways around kinks, and run SLSQP from better ones.

        A pattern search would take many small steps.
        """
        begun, mesh = run.function.evaluations, self.mesh
        axes = np.concatenate([np.eye(run.size), -np.eye(run.size)])
        while mesh >= COARSE and run.function.evaluations - begun < max(most // 10, 1):
            best = known.best(1, 0.0)
            value = known(best)[0]
            around = np.clip(best + mesh * axes, 0.0, 1.0)
            known(around[(around != best).any(axis=1)])
            run.step(f"refinement: mesh {mesh:.2g}")
            better = known.best(1, 0.0)
            if known(better)[0] < value - 1e-9 * abs(value):
                self._descend(run, known, better[0])
            else:
                mesh *= 0.5
        run.function.check()
        return f"converged: no better design within {COARSE:g} of the ranges, nor by SQP"


def _sample(run: Run, count: int) -> FloatArray:
    """Return a Sobol sample, half of it with some parameters on their bounds."""
    from scipy.stats import qmc

    size = 1 << (count - 1).bit_length()
    sample = qmc.Sobol(run.size, scramble=True, seed=run.seed).random(size)[:count]
    sample[1::2] = some_on_bounds(sample[1::2], run.random)
    return np.asarray(sample)


def _different(values: list[float], apart: float) -> int:
    """Count values that are apart from each other."""
    ordered = np.sort(values)
    return 1 + int((np.diff(ordered) > apart).sum())
