"""The stages of a calibration: screening, local fits, identifiability, predictions."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from flexor.arrays import Array
from flexor.calibration.evaluator import Evaluator
from flexor.calibration.identifiability import (
    Identifiability,
    local_identifiability,
    profile_likelihood,
)
from flexor.calibration.local_fit import Minimum, distinct, fit_locally
from flexor.calibration.problem import Problem
from flexor.calibration.record import Record
from flexor.calibration.result import Fit
from flexor.calibration.screening import screen
from flexor.model.interruption import cancel_solves
from flexor.study.executors import DesignEvaluator, Threads

Item = TypeVar("Item")
Result = TypeVar("Result")
_REPORTED_FITS = 8
_PREDICTED_FITS = 4  # for which held-out targets are evaluated
_MAX_REPEATS = 3  # of the analysis, when a profile finds a better fit
_FIT_SEPARATION = 0.02  # in parts of a range, between reported fits


@dataclass(frozen=True)
class Progress:
    """Progress of a running calibration."""

    stage: str
    done: int  # of the stage
    total: int
    misfit: float  # the lowest so far
    evaluated: int  # paths and optima evaluated now
    replayed: int  # those taken from the record of an earlier run


ProgressCallback = Callable[[Progress], None]


class Stages:
    """The stages of a calibration, with their common state."""

    def __init__(
        self,
        problem: Problem,
        record: Record,
        executor: DesignEvaluator,
        progress: ProgressCallback | None,
    ) -> None:
        self._problem, self._record, self._progress = problem, record, progress
        self._evaluator = Evaluator(problem, record, executor)
        self._lowest = np.inf

    def minima(self, samples: int, starts: int, seed: int) -> list[Minimum]:
        """Find the distinct local minima, the best first."""

        def report(done: int, misfit: float) -> None:
            self._report("searching the ranges", done, samples, misfit)

        places = screen(self._evaluator, samples, starts, seed, report)
        return distinct(
            self._map(lambda place: fit_locally(self._evaluator, place), list(places), "refining")
        )

    def analyse(self, minima: list[Minimum]) -> tuple[list[Fit], Identifiability]:
        """Rank the minima, analyse the best, and predict the held-out targets."""
        fits = [Fit(self._problem, minimum, self._values(minimum)) for minimum in minima]
        fits.sort(key=lambda fit: (not fit.met, fit.misfit))
        minimum, identifiability = self._identifiability(fits[0].minimum)
        best = Fit(self._problem, minimum, self._values(minimum))
        others = [
            fit
            for fit in fits[1:]
            if fit.met and np.max(np.abs(fit.minimum.u - minimum.u)) > _FIT_SEPARATION
        ]
        fits = [best, *others[: _REPORTED_FITS - 1]]
        if any(not target.fitted for target in self._problem.targets):
            for i in range(min(len(fits), _PREDICTED_FITS)):
                self._report("predicting held-out targets", i, min(len(fits), _PREDICTED_FITS))
                fits[i] = replace(fits[i], values=self._values(fits[i].minimum, held_out=True))
        return fits, identifiability

    def _identifiability(self, minimum: Minimum) -> tuple[Minimum, Identifiability]:
        """Analyse a minimum, or a better one that a profile leads to.

        Profiles are left out if fits need searches for optima.
        """
        found = local_identifiability(self._evaluator, minimum)
        for _ in range(0 if self._problem.needs_optima else _MAX_REPEATS):
            jobs = [(minimum, i, float(found.deviation[i])) for i in range(len(minimum.u))]
            profiles = self._map(
                lambda job: profile_likelihood(self._evaluator, *job), jobs, "profiling"
            )
            lowest = min((p.lowest for p in profiles), key=lambda m: m.misfit)
            if lowest.misfit >= 0.99 * minimum.misfit - 1e-3:
                return minimum, replace(found, profiles=tuple(profiles))
            minimum = replace(fit_locally(self._evaluator, lowest.u), hits=minimum.hits)
            found = local_identifiability(self._evaluator, minimum)
        return minimum, found

    def _values(self, minimum: Minimum, held_out: bool = False) -> tuple[Array, ...]:
        problem = self._problem
        chosen = range(len(problem.runs)) if held_out else problem.fitted_runs
        runs = {run: self._evaluator.observed(minimum.u[None, :], run)[0] for run in chosen}
        return tuple(
            runs[run][part] if run in runs else np.full(part.stop - part.start, np.nan)
            for run, part in problem.places
        )

    def _map(
        self, function: Callable[[Item], Result], items: list[Item], stage: str
    ) -> list[Result]:
        """Apply a function to items, as many at a time as designs; results in their order."""
        self._report(stage, 0, len(items))
        results: list[Result] = []
        executor = self._evaluator.executor
        threads = executor.threads if isinstance(executor, Threads) else executor.slots
        with ThreadPoolExecutor(threads or os.cpu_count()) as pool:
            futures = [pool.submit(function, item) for item in items]
            try:
                for future in futures:
                    results.append(future.result())
                    misfit = getattr(results[-1], "misfit", np.inf)
                    self._report(stage, len(results), len(items), misfit)
            except BaseException as error:
                self._evaluator.stopped.set()
                if isinstance(error, KeyboardInterrupt):
                    cancel_solves(futures)
                pool.shutdown(cancel_futures=True)
                raise
        return results

    def _report(self, stage: str, done: int, total: int, misfit: float = np.inf) -> None:
        self._lowest = min(self._lowest, misfit)
        if self._progress is not None:
            counts = (self._record.evaluated, self._record.replayed)
            self._progress(Progress(stage, done, total, self._lowest, *counts))
