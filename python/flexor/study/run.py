"""Run a search on a study's problem, through its record."""

from __future__ import annotations

import time

import numpy as np

from flexor.optimizers import Budget, Progress, Search, SearchResult, uses_gradients
from flexor.study.design import Design
from flexor.study.executors import Executor, Threads
from flexor.study.problem import FloatArray
from flexor.study.progress import StudyCallback, StudyProgress
from flexor.study.recorded_evaluator import RecordedEvaluator
from flexor.study.study import Study


def run(
    study: Study,
    search: Search,
    start: FloatArray | None,
    seed: int,
    budget: Budget,
    progress: StudyCallback | None = None,
    executor: Executor | None = None,
) -> SearchResult:
    """Run a search; every evaluation goes through the study's record.

    Parameters
    ----------
    study : Study
        Whose problem is searched and whose record is written.
    search : Search
        The method.
    start : (s, k) array or None
        Where it begins; None draws it from the seed.
    seed : int
        Random seed.
    budget : Budget
        When to stop at the latest.
    progress : callable, optional
        Called with a `StudyProgress` after each iteration.
    executor : Executor, optional
        Where designs are evaluated; in this process by default.

    Returns
    -------
    SearchResult
        What the search found.
    """
    gradients = uses_gradients(search)
    recorded = RecordedEvaluator(study.problem, study.record, executor or Threads(), gradients)
    began = time.monotonic()
    best: Design | None = None

    def report(at: Progress) -> None:
        nonlocal best
        assert progress is not None
        if np.isfinite(at.value) and (best is None or best.value != at.value):
            best = Design.of(study.problem, at.design, study.record.outcomes(at.design))
        left = [at.remaining] if at.remaining is not None else []
        if budget.evaluations is not None:
            left.append(budget.evaluations - at.evaluations)
        progress(
            StudyProgress(
                best=best,
                evaluations=at.evaluations,
                evaluated=recorded.evaluated,
                replayed=recorded.replayed,
                iteration=at.iteration,
                seconds=time.monotonic() - began,
                remaining=min(left) if left else None,
                detail=at.detail,
            )
        )

    chosen = study.problem.parameters
    return search.minimize(
        recorded,
        chosen.lower,
        chosen.upper,
        start=start,
        seed=seed,
        budget=budget,
        progress=report if progress is not None else None,
    )
