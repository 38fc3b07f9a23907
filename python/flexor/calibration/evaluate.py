"""From points of the unit cube to observed values, residuals and misfits, through the record."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from flexor.calibration.follow import PathRun
from flexor.calibration.record import Key, Record
from flexor.calibration.variant import Variant

Array = NDArray[np.float64]
# Parts of a range: wider than the roughness of sphere contacts, narrower than their effect, and
# for optima wider than what a search leaves open.
_STEP, _WIDE = 1e-3, 1e-2


@dataclass(frozen=True, eq=False)
class Evaluator:
    """Evaluates one variant.

    Residuals are (observed - wanted) / standard deviation for each value of each fitted target;
    the misfit is the sum of their squares.

    Attributes
    ----------
    variant : Variant
        What is evaluated.
    number : int
        Which variant it is.
    record : Record
        Where everything goes.
    threads : int
        Threads of the engine; 0 for one per core. Values do not depend on it.
    told : callable
        Called after each evaluation.
    stopped : Event
        Set to make every evaluation raise KeyboardInterrupt, in whatever thread.
    """

    variant: Variant
    number: int
    record: Record
    threads: int = 0
    told: Callable[[], None] = lambda: None
    stopped: threading.Event = field(default_factory=threading.Event)

    def observed(self, u: Array, run: int, haste: bool = False, threads: int = 0) -> Array:
        """Values (n, m) of one run at n points; NaN where it failed."""
        if self.stopped.is_set():
            raise KeyboardInterrupt
        haste = haste and isinstance(self.variant.runs[run], PathRun)
        x = np.ascontiguousarray(self.variant.x(u), dtype="<f8") + 0.0  # one kind of zero
        keys: list[Key] = [(self.number, run, haste, row.tobytes()) for row in x]
        values = [self.record.get(key) for key in keys]
        fresh = {key: row for row, key in enumerate(keys) if values[row] is None}
        if fresh:
            rows = list(fresh.values())
            found = self.variant.runs[run].evaluate(x[rows], haste, threads or self.threads)
            self.record.add(list(fresh), found)
            by_key = dict(zip(fresh, found, strict=True))
            values = [by_key[key] if v is None else v for key, v in zip(keys, values, strict=True)]
        self.told()
        return np.array(values).reshape(len(u), self.variant.runs[run].size)

    def residuals(self, u: Array, runs: Sequence[int], threads: int = 0) -> Array:
        """Residuals (n, r) of the fitted targets of some runs; NaN where a path failed."""
        parts = [self._scaled(self.observed(u, run, threads=threads), run) for run in runs]
        return np.concatenate(parts, axis=1)

    def misfit(self, u: Array, runs: Sequence[int], worst: float = np.inf) -> Array:
        """Misfit (n,) of some runs at n points, in haste; +inf where a path failed.

        Parameters
        ----------
        u : (n, f) array
            Points.
        runs : sequence of int
            Which runs count.
        worst : float
            Where the runs evaluated so far show a misfit above this, the others are spared and
            +inf is returned.
        """
        total = np.zeros(len(u))
        for run in runs:
            rows = np.flatnonzero(total <= worst)
            if rows.size == 0:
                break
            scaled = self._scaled(self.observed(u[rows], run, haste=True), run)
            total[rows] += np.nan_to_num((scaled**2).sum(axis=1), nan=np.inf)
        total[total > worst] = np.inf
        return total

    def slopes(self, u: Array, columns: Sequence[int], runs: Sequence[int]) -> Array:
        """Differentiate the residuals at a point (f,) by some coordinates.

        Parameters
        ----------
        u : (f,) array
            Where.
        columns : sequence of k int
            By which coordinates.
        runs : sequence of int
            Whose residuals.

        Returns
        -------
        (r, k) array
            NaN where a path failed.

        Notes
        -----
        Central differences, over a thousandth of each range for paths and a hundredth for optima,
        which are searched for anew beside the one at the point.
        """
        return np.concatenate([self._slopes(u, columns, run) for run in runs])

    def _slopes(self, u: Array, columns: Sequence[int], run: int) -> Array:
        each = self.variant.runs[run]
        step = _STEP if isinstance(each, PathRun) else _WIDE
        points = np.repeat(u[None, :], 2 * len(columns), axis=0)
        for row, column in enumerate(columns):
            points[2 * row, column] = min(u[column] + step, 1.0)
            points[2 * row + 1, column] = max(u[column] - step, 0.0)
        if isinstance(each, PathRun):
            values = self.observed(points, run, threads=1)
        else:
            best = self.observed(u[None, :], run, threads=1)[0]
            values = each.beside(self.variant.x(points), best)
        found = self._scaled(values, run)
        moved = np.array([points[2 * r, c] - points[2 * r + 1, c] for r, c in enumerate(columns)])
        return np.asarray(((found[::2] - found[1::2]) / moved[:, None]).T)

    def _scaled(self, values: Array, run: int) -> Array:
        parts = [
            (values[:, part] - goal.value) / goal.deviation
            for goal, part in self.variant.of_run(run)
        ]
        return np.concatenate(parts, axis=1)
