"""One search of a comparison."""

from __future__ import annotations

import time
from dataclasses import dataclass

from flexor.optimizers import Budget, Search, SearchResult, uses_gradients
from flexor.study.executors import Threads
from flexor.study.problem import FloatArray, Problem
from flexor.study.record import Record
from flexor.study.recorded_evaluator import RecordedEvaluator


@dataclass(frozen=True, eq=False)
class SearchTask:
    """A search to be done.

    Attributes
    ----------
    search : Search
        The method.
    start : (s, k) array
        Where it begins.
    seed : int
        Random seed.
    budget : int
        Evaluations.
    """

    search: Search
    start: FloatArray
    seed: int
    budget: int

    @property
    def gradients(self) -> bool:
        """Whether the method asks for gradients."""
        return uses_gradients(self.search)

    def run(self, problem: Problem, function: RecordedEvaluator) -> SearchResult:
        """Search a problem through its recorded function."""
        return self.search.minimize(
            function,
            problem.parameters.lower,
            problem.parameters.upper,
            start=self.start,
            seed=self.seed,
            budget=Budget(evaluations=self.budget),
        )


def search_in_memory(problem: Problem, task: SearchTask) -> tuple[SearchResult, float]:
    """Search with a record in memory, on one thread.

    Parameters
    ----------
    problem : Problem
        What is searched.
    task : SearchTask
        How.

    Returns
    -------
    result, seconds : SearchResult, float
        What was found, and how long that took [s].
    """
    began, record = time.monotonic(), Record(None, problem.sizes)
    try:
        result = task.run(problem, RecordedEvaluator(problem, record, Threads(1), task.gradients))
    finally:
        record.close()
    return result, time.monotonic() - began
