"""Optimal designs as observables: their parameters and their bending."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.arrays import Array
from flexor.calibration.system import System
from flexor.design import ParameterSet
from flexor.objectives import Objective
from flexor.optimizers import PatternSearch, Search
from flexor.study import Threads, optimize

BENDING = "bending"
_SEARCH = 1000.0  # load steps that a search costs, about, for each of its parameters
_LOCAL = PatternSearch(initial_mesh=0.02, tolerance=2e-3)


@dataclass(frozen=True, eq=False)
class OptimumRun:
    """The optimal design of a parameter set, searched for each set of constants.

    Its values are the parameters of the optimal design, and its bending.
    """

    system: System
    parameters: ParameterSet
    objective: Objective
    method: Search

    @property
    def size(self) -> int:
        """Number of values."""
        return self.parameters.size + 1

    @property
    def cost(self) -> float:
        """Relative cost, for ordering."""
        return _SEARCH * self.parameters.size

    def column(self, part: str) -> slice:
        """Return where a parameter, or ``"bending"``, is among the values."""
        labels = (*self.parameters.labels, BENDING)
        return slice(labels.index(part), labels.index(part) + 1)

    def evaluate(self, x: Array, screening: bool = False, threads: int = 1) -> Array:
        """Observe n sets of constants (n, c); see `PathRun.evaluate`."""
        del screening
        return np.array([self._searched(row, self.method, None, threads) for row in x])

    def beside(self, x: Array, best: Array) -> Array:
        """Observe n sets of constants (n, c) close to one whose values (k + 1,) are known.

        Only the neighbourhood of the known optimum is searched: cheaper than a whole search, and
        continuous with it.
        """
        return np.array([self._searched(row, _LOCAL, best[:-1], 1) for row in x])

    def _searched(self, x: Array, method: Search, start: Array | None, threads: int) -> Array:
        study = optimize(
            self.system.model(x),
            self.parameters,
            self.objective,
            method,
            start=start,
            executor=Threads(threads),
        )
        if study.record.best() is None:
            return np.full(self.size, np.nan)
        return np.append(study.best.vector, study.best.bending)
