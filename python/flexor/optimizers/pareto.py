"""A front of designs between several objectives: NSGA-II, then sequential quadratic programming."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run, penalize_failures
from flexor.optimizers.options import at_least, at_most, option
from flexor.optimizers.sqp import Linearization, achieve, differences, minimize_slsqp

# Gaps of a front below this share of its range are not worth a search.
NARROW = 1e-3


def nondominated(values: FloatArray) -> NDArray[np.intp]:
    """Return the rows of values (n, m), to be minimised, that no other row is better than in all.

    In the order of the first value, then of the next; of equal rows the first.
    """
    _, first = np.unique(values, axis=0, return_index=True)  # sorted by the first value
    kept: list[int] = []
    for row in first:
        found = values[kept]
        if not np.any(np.all(found <= values[row], axis=1)):
            kept.append(int(row))
    return np.array(kept, dtype=np.intp)


@dataclass(frozen=True)
class Pareto(Method):
    """NSGA-II (Deb et al. 2002), then SLSQP (Kraft 1988) towards, along and into the front.

    The population finds the parts of the front. From the best designs of each objective SLSQP goes
    to the ends of the front, from others that are spread over it to the front along the diagonal
    of the objectives (achievement scalarising functions, Wierzbicki 1980), and with two objectives
    then again and again into the widest gap.

    Attributes
    ----------
    population, generations : int
        Of NSGA-II; the first generation includes the given starts.
    descents : int
        Number of searches by SLSQP.
    iterations : int
        Maximum number of iterations of each.
    difference : float
        Step of the differences, as a fraction of the ranges.
    """

    name = "pareto"
    title = "NSGA-II and SQP"
    aliases = ("nsga-ii", "nsga2")
    description = "several objectives: NSGA-II, refined by SQP towards and along the front"
    packages = ("pymoo", "scipy")
    several: ClassVar[bool] = True

    population: int = option(40, at_least(4))
    generations: int = option(13, at_least(1))
    descents: int = option(60, at_least(0))
    iterations: int = option(12, at_least(1))
    difference: float = option(1e-5, at_most(0.1))

    def run(self, run: Run) -> str:
        """Evolve a population, then refine its front."""
        archive = _Archive(run)
        self._evolve(run, archive)
        if not len(archive.front()):
            return "no design that was tried keeps the constraints"
        self._refine(run, archive)
        return f"{len(archive.front())} designs in the front"

    def _evolve(self, run: Run, archive: _Archive) -> None:
        """Run NSGA-II."""
        from pymoo.algorithms.moo.nsga2 import NSGA2
        from pymoo.core.evaluator import Evaluator
        from pymoo.core.problem import Problem
        from pymoo.core.termination import NoTermination
        from pymoo.operators.crossover.sbx import SBX
        from pymoo.operators.mutation.pm import PM
        from pymoo.problems.static import StaticProblem

        starts = run.starts(self.population)
        values, excesses = archive(starts)
        k, m, c = run.size, values.shape[1], excesses.shape[1]
        problem = Problem(n_var=k, n_obj=m, n_ieq_constr=c, xl=np.zeros(k), xu=np.ones(k))
        algorithm: Any = NSGA2(
            pop_size=self.population, sampling=starts, crossover=SBX(), mutation=PM()
        )
        algorithm.setup(problem, termination=NoTermination(), seed=run.seed, verbose=False)
        for _ in range(self.generations):
            infills = algorithm.ask()
            if infills is None or len(infills) == 0:
                return
            values, excesses = archive(infills.get("X").astype(np.float64))
            found: dict[str, Any] = {"F": penalize_failures(values)}
            if c:
                found["G"] = np.nan_to_num(excesses, nan=1e6)
            Evaluator().eval(StaticProblem(problem, **found), infills)
            algorithm.tell(infills=infills)
            run.step(f"front of {len(archive.front())}")

    def _refine(self, run: Run, archive: _Archive) -> None:
        """Search from designs of the front, one after the other."""

        def linearize(point: FloatArray) -> Linearization:
            return differences(archive, point, self.difference)

        def only(index: int, point: FloatArray) -> Linearization:
            found = linearize(point)
            rows = [index, *(i for i in range(len(found.values)) if i != index)]
            return Linearization(
                found.values[rows], found.gradients[rows], found.excesses, found.slopes
            )

        points, values = archive.front_points()
        m = values.shape[1]
        for i in range(min(m, self.descents)):
            start = points[int(np.argmin(values[:, i]))]
            minimize_slsqp(start, partial(only, i), self.iterations, step=run.step)
        left = self.descents - m
        tried: set[bytes] = set()
        # With two objectives most of the searches are for the gaps.
        for _ in range(left // 3 if m == 2 else left):
            points, values = archive.front_points()
            scale = _scale(values)
            chosen = _farthest(values / scale, [row.tobytes() in tried for row in points])
            if chosen is None:
                break
            tried.add(points[chosen].tobytes())
            achieve(run, points[chosen], linearize, values[chosen], scale, self.iterations)
        gaps: set[bytes] = set()
        for _ in range(left - left // 3 if m == 2 else 0):
            points, values = archive.front_points()
            scale = _scale(values)
            width = np.abs(np.diff(values / scale, axis=0)).max(axis=1)
            ends = [points[i].tobytes() + points[i + 1].tobytes() for i in range(len(width))]
            open_ = [i for i in np.argsort(-width, kind="stable") if ends[i] not in gaps]
            if not open_ or width[open_[0]] < NARROW:
                break
            i = int(open_[0])
            gaps.add(ends[i])
            middle, aim = 0.5 * (points[i] + points[i + 1]), 0.5 * (values[i] + values[i + 1])
            achieve(run, middle, linearize, aim, scale, self.iterations)


class _Archive:
    """Objectives of a run, with all feasible points so far."""

    def __init__(self, run: Run) -> None:
        self._run = run
        self._points: list[FloatArray] = []
        self._values: list[FloatArray] = []

    def __call__(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return values (n, m) and excesses (n, c) at points (n, k)."""
        values, excesses = self._run.objectives(points)
        good = np.isfinite(values).all(axis=1) & ~(excesses > 0.0).any(axis=1)
        self._points += list(points[good])
        self._values += list(values[good])
        return values, excesses

    def front(self) -> NDArray[np.intp]:
        """Return which of the feasible points are in the front, in order; see `nondominated`."""
        if not self._values:
            return np.zeros(0, dtype=np.intp)
        chosen = nondominated(np.array(self._values))
        self._points = [self._points[i] for i in chosen]
        self._values = [self._values[i] for i in chosen]
        return np.arange(len(chosen))

    def front_points(self) -> tuple[FloatArray, FloatArray]:
        """Return points (p, k) and values (p, m) of the front, in order."""
        rows = self.front()
        return np.array(self._points)[rows], np.array(self._values)[rows]


def _scale(values: FloatArray) -> FloatArray:
    """Return the range of each objective along a front, (m,)."""
    width = np.ptp(values, axis=0)
    return np.asarray(np.where(width > 0.0, width, np.maximum(np.abs(values[0]), 1e-12)))


def _farthest(values: FloatArray, used: list[bool]) -> int | None:
    """Return the row farthest from those used, and from the ends; None if all are used."""
    done = np.array(used)
    done[np.argmin(values, axis=0)] = True
    if done.all():
        return None
    apart = np.abs(values[:, None, :] - values[None, done, :]).max(axis=2).min(axis=1)
    apart[done] = -1.0
    return int(np.argmax(apart))
