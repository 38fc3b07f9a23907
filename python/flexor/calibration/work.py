"""The stages of a calibration: search, refine, judge, predict."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from flexor.calibration.calibration import Fit, ranked
from flexor.calibration.evaluate import Evaluator
from flexor.calibration.explore import explore
from flexor.calibration.knowledge import Knowledge, know, profile
from flexor.calibration.progress import Progress, ProgressCallback
from flexor.calibration.record import Record
from flexor.calibration.refine import Minimum, distinct, refine
from flexor.calibration.variant import Variant
from flexor.errors import InputError

Array = NDArray[np.float64]
Item = TypeVar("Item")
Result = TypeVar("Result")
_FITS = 8  # that are reported
_PREDICTED = 4  # for which held-out targets are evaluated as well
_AGAIN = 3  # times a fit may be begun anew from something better found beside it


class Work:
    """The stages of a calibration, with what they share."""

    def __init__(
        self,
        record: Record,
        made: Sequence[Variant],
        threads: int,
        progress: ProgressCallback | None,
    ) -> None:
        self._record, self._progress = record, progress
        self._workers = threads or os.cpu_count() or 1
        self._stopped = threading.Event()
        self._best = np.inf
        self._evaluators = [
            Evaluator(variant, number, record, threads, stopped=self._stopped)
            for number, variant in enumerate(made)
        ]

    def check_reproduces(self) -> None:
        """Refuse to go on if what was recorded first now comes out differently.

        Raises
        ------
        InputError
            If it does.
        """
        first = self._record.first()
        if first is None:
            return
        (number, run, haste, constants), recorded = first
        x = np.frombuffer(constants, dtype="<f8")[None, :]
        found = self._evaluators[number].variant.runs[run].evaluate(x, haste, 1)[0]
        if not np.allclose(found, recorded, rtol=1e-6, atol=1e-9, equal_nan=True):
            raise InputError(
                "the record of the calibration no longer reproduces (the models or the engine "
                "have changed): begin another."
            )

    def minima(self, number: int, samples: int, starts: int, seed: int) -> list[Minimum]:
        """Find the different minima of a variant, the best first."""
        evaluator = self._evaluators[number]
        prefix = f"{number + 1}/{len(self._evaluators)} " if len(self._evaluators) > 1 else ""

        def told(done: int, misfit: float) -> None:
            self._tell(f"{prefix}searching the ranges", done, samples, misfit)

        places = explore(evaluator, samples, starts, seed, told)
        ended = self._each(
            lambda place: refine(evaluator, place), list(places), f"{prefix}refining"
        )
        return distinct(ended)

    def judged(self, minima: Sequence[list[Minimum]]) -> tuple[list[Fit], Knowledge]:
        """Rank all minima, work out what the best says, and predict what was held out."""
        fits = ranked(
            [
                Fit(evaluator.variant, minimum, self._values(evaluator, minimum, fitted=True))
                for evaluator, found in zip(self._evaluators, minima, strict=True)
                for minimum in found
            ]
        )
        best, knowledge = self._known(fits[0])
        rest = [fit for fit in fits[1:] if fit.variant is not best.variant or _apart(fit, best)]
        fits = _reported([best, *rest])
        return self._predicted(fits), knowledge

    def _known(self, best: Fit) -> tuple[Fit, Knowledge]:
        """Say what the targets know of the best fit's constants.

        Profiles come with it, but where fits need searches for optima. Where a profile finds
        something better, it is taken and looked at again.
        """
        evaluator, minimum = self._evaluator(best), best.minimum
        knowledge = know(evaluator, minimum)
        for _ in range(0 if best.variant.dear else _AGAIN):
            jobs = [(minimum, i, float(knowledge.deviation[i])) for i in range(len(minimum.u))]
            profiles = self._each(lambda job: profile(evaluator, *job), jobs, "profiling")
            lowest = min((p.lowest for p in profiles), key=lambda m: m.misfit)
            if lowest.misfit >= 0.99 * minimum.misfit - 1e-3:
                knowledge = replace(knowledge, profiles=tuple(profiles))
                break
            minimum = replace(refine(evaluator, lowest.u), hits=minimum.hits)
            knowledge = know(evaluator, minimum)
        values = self._values(evaluator, minimum, fitted=True)
        return replace(best, minimum=minimum, values=values), knowledge

    def _predicted(self, fits: list[Fit]) -> list[Fit]:
        """Evaluate the held-out targets of the fits worth it."""
        held = any(not goal.fitted for goal in fits[0].variant.goals)
        worth = [fit for fit in fits if fit.met or fit is fits[0]][:_PREDICTED] if held else []
        for done, fit in enumerate(worth):
            self._tell("predicting what was held out", done, len(worth))
            values = self._values(self._evaluator(fit), fit.minimum, fitted=False)
            fits[fits.index(fit)] = replace(fit, values=values)
        return fits

    def _values(self, evaluator: Evaluator, minimum: Minimum, fitted: bool) -> tuple[Array, ...]:
        variant = evaluator.variant
        wanted = variant.fitted_runs if fitted else range(len(variant.runs))
        runs = {run: evaluator.observed(minimum.u[None, :], run)[0] for run in wanted}
        return tuple(
            runs[run][part] if run in runs else np.full(part.stop - part.start, np.nan)
            for run, part in variant.places
        )

    def _evaluator(self, fit: Fit) -> Evaluator:
        return next(each for each in self._evaluators if each.variant is fit.variant)

    def _each(
        self, function: Callable[[Item], Result], items: list[Item], stage: str
    ) -> list[Result]:
        """Apply a function to items on all cores; results in their order."""
        self._tell(stage, 0, len(items))
        done = 0
        results: dict[int, Result] = {}
        with ThreadPoolExecutor(self._workers) as pool:
            futures = {i: pool.submit(function, item) for i, item in enumerate(items)}
            try:
                for i, future in futures.items():
                    results[i] = future.result()
                    done += 1
                    if isinstance(results[i], Minimum):
                        self._best = min(self._best, results[i].misfit)  # type: ignore[attr-defined]
                    self._tell(stage, done, len(items))
            except BaseException:
                self._stopped.set()
                pool.shutdown(cancel_futures=True)
                raise
        return [results[i] for i in range(len(items))]

    def _tell(self, stage: str, done: int, total: int, misfit: float = np.inf) -> None:
        self._best = min(self._best, misfit)
        if self._progress is not None:
            known = self._record
            self._progress(
                Progress(stage, done, total, self._best, known.evaluated, known.replayed)
            )


def _apart(first: Fit, second: Fit) -> bool:
    return bool(np.max(np.abs(first.minimum.u - second.minimum.u)) > 0.02)


def _reported(fits: list[Fit]) -> list[Fit]:
    """Keep the fits that meet every hard target, and the best of every variant."""
    kept: list[Fit] = []
    for fit in fits:
        new = all(fit.variant is not other.variant for other in kept)
        if new or (fit.met and len(kept) < _FITS):
            kept.append(fit)
    return kept
