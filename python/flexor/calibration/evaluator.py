"""From points of the unit cube to observed values, residuals and misfits, through the record."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np

from flexor.arrays import Array
from flexor.calibration.optimum_run import OptimumRun
from flexor.calibration.path_run import PathRun
from flexor.calibration.problem import Problem
from flexor.calibration.record import Key, Record
from flexor.study.executors import DesignEvaluator, Threads

# Difference steps as parts of a range: for paths wider than the roughness of sphere contacts and
# narrower than their effect, for optima wider than the tolerance of a search.
_PATH_STEP, _OPTIMUM_STEP = 1e-3, 1e-2


@dataclass(frozen=True, eq=False)
class Evaluator:
    """Evaluates a problem and records every evaluation.

    Residuals are (observed - target value) / standard deviation for each value of each fitted
    target; the misfit is the sum of their squares.
    """

    problem: Problem
    record: Record
    executor: DesignEvaluator = field(default_factory=Threads)
    # Set to make every evaluation raise KeyboardInterrupt, in any thread.
    stopped: threading.Event = field(default_factory=threading.Event)

    def observed(self, u: Array, run: int, screening: bool = False, threads: int = 0) -> Array:
        """Return the values (n, m) of one run at n points; NaN where it failed.

        In this process they are evaluated on ``threads`` threads, by default those of the executor.
        """
        if self.stopped.is_set():
            raise KeyboardInterrupt
        screening = screening and isinstance(self.problem.runs[run], PathRun)
        x = np.ascontiguousarray(self.problem.x(u), dtype="<f8") + 0.0  # no negative zeros
        keys: list[Key] = [(run, screening, row.tobytes()) for row in x]
        values = [self.record.get(key) for key in keys]
        fresh = {key: row for row, key in enumerate(keys) if values[row] is None}
        if fresh:
            rows = list(fresh.values())
            found = self._evaluate(x[rows], run, screening, threads)
            self.record.add(list(fresh), found)
            by_key = dict(zip(fresh, found, strict=True))
            values = [by_key[key] if v is None else v for key, v in zip(keys, values, strict=True)]
        return np.array(values).reshape(len(u), self.problem.runs[run].size)

    def residuals(self, u: Array, runs: Sequence[int], threads: int = 0) -> Array:
        """Return the residuals (n, r) of the fitted targets of some runs; NaN where one failed."""
        parts = [self._residuals(self.observed(u, run, threads=threads), run) for run in runs]
        return np.concatenate(parts, axis=1)

    def misfit(self, u: Array, runs: Sequence[int], worst: float = np.inf) -> Array:
        """Screen n points: misfit (n,) of some runs, +inf where one failed.

        A point whose misfit exceeds `worst` after some of the runs is dropped, with +inf.
        """
        total = np.zeros(len(u))
        for run in runs:
            rows = np.flatnonzero(total <= worst)
            if rows.size == 0:
                break
            residuals = self._residuals(self.observed(u[rows], run, screening=True), run)
            total[rows] += np.nan_to_num((residuals**2).sum(axis=1), nan=np.inf)
        total[total > worst] = np.inf
        return total

    def jacobian(self, u: Array, columns: Sequence[int], runs: Sequence[int]) -> Array:
        """Differentiate the residuals of some runs at a point (c,) by k coordinates, (r, k).

        Central differences over a thousandth of each range for paths and a hundredth for optima,
        which are searched again next to the one at the point; NaN where a run failed.
        """
        return np.concatenate([self._jacobian(u, columns, run) for run in runs])

    def _jacobian(self, u: Array, columns: Sequence[int], run: int) -> Array:
        each = self.problem.runs[run]
        step = _PATH_STEP if isinstance(each, PathRun) else _OPTIMUM_STEP
        points = np.repeat(u[None, :], 2 * len(columns), axis=0)
        for row, column in enumerate(columns):
            points[2 * row, column] = min(u[column] + step, 1.0)
            points[2 * row + 1, column] = max(u[column] - step, 0.0)
        if isinstance(each, PathRun):
            values = self.observed(points, run, threads=1)
        else:
            best = self.observed(u[None, :], run, threads=1)[0]
            values = self.executor.call(
                self.problem,
                _beside,
                run,
                self.problem.x(points),
                best,
                stopped=self.stopped.is_set,
            )
        found = self._residuals(values, run)
        moved = np.array([points[2 * r, c] - points[2 * r + 1, c] for r, c in enumerate(columns)])
        return np.asarray(((found[::2] - found[1::2]) / moved[:, None]).T)

    def _evaluate(self, x: Array, run: int, screening: bool, threads: int) -> Array:
        """Evaluate one run with n sets of constants (n, c), on all workers of the executor."""
        if isinstance(self.executor, Threads):
            threads = threads or self.executor.threads
            return self.problem.runs[run].evaluate(x, screening, threads)
        parts = np.array_split(x, min(len(x), self.executor.slots))

        def evaluated(part: Array) -> Array:
            return self.executor.call(
                self.problem, _evaluated, run, part, screening, stopped=self.stopped.is_set
            )

        with ThreadPoolExecutor(len(parts)) as waiting:
            return np.concatenate(list(waiting.map(evaluated, parts)))

    def _residuals(self, values: Array, run: int) -> Array:
        parts = [
            (values[:, part] - target.value) / target.deviation
            for target, part in self.problem.of_run(run)
        ]
        return np.concatenate(parts, axis=1)


def _evaluated(problem: Problem, run: int, x: Array, screening: bool) -> Array:
    """Evaluate a run on a worker."""
    return problem.runs[run].evaluate(x, screening, 1)


def _beside(problem: Problem, run: int, x: Array, best: Array) -> Array:
    """Evaluate a run close to a known optimum on a worker."""
    searched = problem.runs[run]
    assert isinstance(searched, OptimumRun)
    return searched.beside(x, best)
