"""Results of a comparison of methods: every search, and statistics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor.constraints import INFEASIBLE, feasible_parts
from flexor.errors import unknown
from flexor.objectives import Objective
from flexor.optimizers import SearchResult
from flexor.study.problem import FloatArray

# "Within 1 % of the best known": of its gain; see `MethodComparison.target`.
WITHIN = 0.01


@dataclass(frozen=True, eq=False)
class SearchRun:
    """One search of a comparison."""

    parameters: str  # name of the set
    method: str  # its label
    seed: int  # of start and method
    result: SearchResult
    seconds: float  # time on one thread (or on the executor) [s]; NaN if it was interrupted

    def evaluations_to(self, target: float) -> float:
        """Return after how many evaluations a value was reached; +inf if it was not."""
        reached = np.flatnonzero(self.result.improvement_values <= target)
        return float(self.result.improvement_evaluations[reached[0]]) if reached.size else np.inf


@dataclass(frozen=True)
class Summary:
    """Statistics of the searches of one method on one set."""

    parameters: str
    method: str
    searches: int  # their number
    # Of the final values; of infeasible designs what they rank by, see `flexor.constraints.ranks`.
    best: float
    median: float
    worst: float
    success: float  # fraction that reached the target
    # Median evaluations to the target among successful searches; +inf if there are none.
    evaluations: float
    # Expected evaluations to the target if unsuccessful searches are restarted (total of all
    # searches, up to the target, per success); +inf without success.
    expected_evaluations: float
    spent: float  # median total evaluations
    seconds: float  # median time [s]; NaN if every search was interrupted


@dataclass(frozen=True, eq=False)
class MethodComparison:
    """Every method from the same starts, seeds and budget on each parameter set."""

    model: str  # its name
    objective: Objective
    budget: int  # evaluations of each search
    sets: Mapping[str, int]  # number of parameters of each
    methods: tuple[str, ...]  # labels, in the given order
    seeds: tuple[int, ...]  # one for each search
    # Value of each set's own start, against which gains are measured.
    reference: Mapping[str, float]
    runs: tuple[SearchRun, ...]
    known: Mapping[str, float] = field(default_factory=dict)  # best values known from elsewhere

    def of(self, parameters: str, method: str | None = None) -> list[SearchRun]:
        """Return the searches of a set, by one method or all; InputError if unknown."""
        if parameters not in self.sets:
            raise unknown("parameter set of the comparison", parameters, self.sets)
        if method is not None and method not in self.methods:
            raise unknown("method of the comparison", method, self.methods)
        runs = [run for run in self.runs if run.parameters == parameters]
        return [run for run in runs if method in (None, run.method)]

    def best(self, parameters: str) -> SearchRun:
        """Return the search of a set that found the best design."""
        return min(self.of(parameters), key=lambda run: run.result.value)

    def best_known(self, parameters: str) -> float:
        """Return the best value known of a set: of all searches, or from elsewhere."""
        return min(self.best(parameters).result.value, self.known.get(parameters, np.inf))

    def target(self, parameters: str, within: float = WITHIN) -> float:
        """Return the value that counts as success on a set.

        The gain of a design is how far its value lies below that of the set's own start. Success
        is all but ``within`` of the gain of the best known design: f0 - (1 - within) (f0 - f*),
        the convergence test of Moré and Wild (2009) with one f0 for all. If that start fails or is
        infeasible, f0 is the highest of the first feasible values of all searches. Where no
        feasible design is known, nothing is a success: -inf.
        """
        first, best = self.reference[parameters], self.best_known(parameters)
        if not best < INFEASIBLE:
            return -np.inf
        if not first < INFEASIBLE:
            values = [run.result.improvement_values for run in self.of(parameters)]
            begun = [found[found < INFEASIBLE][:1] for found in values]
            first = float(np.max(np.concatenate(begun), initial=best))
        return max(best, first - (1.0 - within) * (first - best))

    def summary(self, parameters: str, method: str, within: float = WITHIN) -> Summary:
        """Summarise the searches of a method on a set."""
        runs, target = self.of(parameters, method), self.target(parameters, within)
        values = np.array([run.result.value for run in runs])
        spent = np.array([run.result.evaluations for run in runs], dtype=np.float64)
        needed = np.array([run.evaluations_to(target) for run in runs])
        reached = np.isfinite(needed)
        seconds = np.array([run.seconds for run in runs if np.isfinite(run.seconds)])
        successes = int(reached.sum())
        return Summary(
            parameters=parameters,
            method=method,
            searches=len(runs),
            best=float(values.min()),
            median=_median(values),
            worst=float(values.max()),
            success=successes / len(runs),
            evaluations=float(np.median(needed[reached])) if successes else np.inf,
            expected_evaluations=float(np.where(reached, needed, spent).sum() / successes)
            if successes
            else np.inf,
            spent=float(np.median(spent)),
            seconds=float(np.median(seconds)) if seconds.size else np.nan,
        )

    def summaries(self, within: float = WITHIN) -> list[Summary]:
        """Summarise every method on every set."""
        return [self.summary(s, m, within) for s in self.sets for m in self.methods]

    def table(self, within: float = WITHIN) -> dict[str, NDArray[Any]]:
        """Every search as a row, in columns ready for ``pandas.DataFrame``.

        Returns
        -------
        dict of (n,) arrays
            ``parameters``, ``method``, ``seed``, ``start`` and ``value`` (where it began and
            ended; NaN if that is infeasible), ``start_excess`` and ``excess`` (by how much it is),
            ``evaluations``, ``to_target`` (+inf if not reached), ``seconds``, ``reason``.
        """
        targets = {name: self.target(name, within) for name in self.sets}
        results = [run.result for run in self.runs]
        starts = [next(iter(result.improvement_values), np.inf) for result in results]
        (start, start_excess), (value, excess) = (
            feasible_parts(np.array(ranked, dtype=float))
            for ranked in (starts, [result.value for result in results])
        )
        columns: dict[str, list[Any]] = {
            "parameters": [run.parameters for run in self.runs],
            "method": [run.method for run in self.runs],
            "seed": [run.seed for run in self.runs],
            "start": start.tolist(),
            "start_excess": start_excess.tolist(),
            "value": value.tolist(),
            "excess": excess.tolist(),
            "evaluations": [result.evaluations for result in results],
            "to_target": [run.evaluations_to(targets[run.parameters]) for run in self.runs],
            "seconds": [run.seconds for run in self.runs],
            "reason": [result.reason for result in results],
        }
        return {
            name: np.array(column, dtype=object if isinstance(column[0], str) else None)
            for name, column in columns.items()
        }

    def needed(self, method: str, within: float = WITHIN) -> FloatArray:
        """Count the evaluations to each target, (sets, seeds); +inf where it was not reached."""
        rows = []
        for parameters in self.sets:
            target = self.target(parameters, within)
            runs = sorted(self.of(parameters, method), key=lambda run: run.seed)
            rows.append([run.evaluations_to(target) for run in runs])
        return np.array(rows)


def _median(values: FloatArray) -> float:
    """Return the median; between a feasible and an infeasible design the latter."""
    mixed = np.any(values >= INFEASIBLE)
    return float(np.quantile(values, 0.5, method="higher" if mixed else "linear"))
