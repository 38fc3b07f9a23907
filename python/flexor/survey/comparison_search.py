"""One search of a comparison: what is asked of it, and doing it where nothing is kept."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

from flexor.optimizers import Budget, Search, SearchResult, uses_gradients
from flexor.study import Problem, Record, RecordedEvaluator, Threads
from flexor.study.problem import FloatArray


@dataclass(frozen=True, eq=False)
class Asked:
    """What is asked of a search.

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

    def of(self, problem: Problem, function: RecordedEvaluator) -> SearchResult:
        """Search a problem through its recorded function."""
        return self.search.minimize(
            function,
            problem.parameters.lower,
            problem.parameters.upper,
            start=self.start,
            seed=self.seed,
            budget=Budget(evaluations=self.budget),
        )


def search_alone(problem: Problem, asked: Asked) -> tuple[SearchResult, float]:
    """Search with a record in memory, on one thread.

    Parameters
    ----------
    problem : Problem
        What is searched.
    asked : Asked
        How.

    Returns
    -------
    result, seconds : SearchResult, float
        What was found, and how long that took [s].
    """
    began, record = time.monotonic(), open_record(problem, None)
    try:
        result = asked.of(problem, RecordedEvaluator(problem, record, Threads(1), asked.gradients))
    finally:
        record.close()
    return result, time.monotonic() - began


def open_record(problem: Problem, path: Path | None) -> Record:
    """Open the record of a search, or make one.

    Parameters
    ----------
    problem : Problem
        What is searched.
    path : Path or None
        The file; None for one in memory.
    """
    sizes = (problem.parameters.size, problem.force.size, len(problem.model.joints))
    if path is None:
        return Record(None, sizes)
    path.parent.mkdir(exist_ok=True)
    return Record(path) if path.exists() else Record(path, sizes)
