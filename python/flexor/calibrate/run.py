"""Run a calibration, or go on with one."""

from __future__ import annotations

import hashlib
import os
import threading
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from flexor.calibrate import folder as folders
from flexor.calibrate.calibration import Calibration, Fit, ranked
from flexor.calibrate.combine import variants
from flexor.calibrate.evaluate import Evaluator
from flexor.calibrate.explore import default_samples, explore
from flexor.calibrate.knowledge import Knowledge, know, profile
from flexor.calibrate.reading import read
from flexor.calibrate.record import Record
from flexor.calibrate.refine import Minimum, distinct, refine
from flexor.calibrate.variant import Variant
from flexor.errors import InputError
from flexor.model import Model
from flexor.study.lock import Lock

Array = NDArray[np.float64]
Item = TypeVar("Item")
Result = TypeVar("Result")
_FITS = 8  # that are reported
_PREDICTED = 4  # for which held-out targets are evaluated as well
_AGAIN = 3  # times a fit may be begun anew from something better found beside it


@dataclass(frozen=True)
class Progress:
    """Where a calibration stands.

    Attributes
    ----------
    stage : str
        What it is doing.
    done, total : int
        How much of that.
    misfit : float
        The lowest so far.
    evaluated, replayed : int
        Paths and optima evaluated now, and known from an earlier run.
    """

    stage: str
    done: int
    total: int
    misfit: float
    evaluated: int
    replayed: int


def calibrate(
    model: Model,
    targets: str | Path,
    *,
    seed: int = 0,
    samples: int | None = None,
    starts: int | None = None,
    chosen: Mapping[str, str] | None = None,
    folder: str | Path | None = None,
    resume: bool = False,
    threads: int = 0,
    progress: Callable[[Progress], None] | None = None,
) -> Calibration:
    """Find the constants with which models meet their targets.

    Parameters
    ----------
    model : Model
        The model that is calibrated; the targets file may name more that share its constants.
    targets : path
        The targets file.
    seed : int
        Of everything drawn at random.
    samples, starts : int, optional
        Points of the global search and how many of them are refined; the file's, or else by the
        number of constants.
    chosen : dict, optional
        Options by choice, where not all are to be tried.
    folder : path, optional
        Where to keep the calibration; in memory by default.
    resume : bool
        Go on with the calibration in ``folder``, whose settings must be these.
    threads : int
        0 for one per core. Results do not depend on it.
    progress : callable, optional
        Told a `Progress` now and then.

    Returns
    -------
    Calibration
        The fits, and what the targets say about the constants.

    Raises
    ------
    InputError
        If the targets file cannot be used, or the folder cannot.

    Notes
    -----
    For every combination of options an even cover of the ranges (`explore`), bounded least squares
    from its best places (`refine`), and the different minima of these. For the best of all, the
    singular directions and the profile of each constant (`knowledge`). Resuming is running again
    with known evaluations answered from the record; KeyboardInterrupt passes through and leaves a
    calibration that can be resumed.
    """
    file, text = read(targets)
    made = variants(file, model, str(targets), chosen)
    starts = starts or file.search.starts
    counts = [samples or file.search.samples or default_samples(len(v.free)) for v in made]
    settings = _settings(made, text, seed, counts, starts)
    with ExitStack() as stack:
        place = None if folder is None else Path(folder)
        if place is None:
            if resume:
                raise InputError("resuming a calibration needs its folder.")
        else:
            if resume:
                folders.check_same(place, settings)
            else:
                folders.create(place, settings, text)
            stack.callback(Lock(place).release)
        record = Record(None if place is None else place / folders.RECORD)
        stack.callback(record.close)
        work = _Work(record, made, threads, progress)
        if resume:
            work.check_reproduces()
        minima = [work.minima(i, counts[i], starts, seed) for i in range(len(made))]
        fits, knowledge = work.judged(minima)
        return Calibration(
            title=file.title,
            source=str(targets),
            fits=tuple(fits),
            knowledge=knowledge,
            seed=seed,
            evaluations=len(record),
            folder=place,
        )


class _Work:
    """The stages of a calibration, with what they share."""

    def __init__(
        self,
        record: Record,
        made: Sequence[Variant],
        threads: int,
        progress: Callable[[Progress], None] | None,
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
        """Profile the best fit; where that finds something better, begin again there."""
        evaluator = self._evaluator(best)
        minimum = best.minimum
        for turn in range(_AGAIN):
            knowledge = know(evaluator, minimum)
            base, found = knowledge, minimum
            profiles = self._each(
                lambda i: profile(evaluator, found, i, float(base.deviation[i])),  # noqa: B023
                list(range(len(minimum.u))),
                "profiling",
            )
            lowest = min((p.lowest for p in profiles), key=lambda m: m.misfit)
            if lowest.misfit >= 0.99 * minimum.misfit - 1e-3 or turn == _AGAIN - 1:
                break
            minimum = replace(refine(evaluator, lowest.u), hits=minimum.hits)
        values = self._values(evaluator, minimum, fitted=True)
        return Fit(best.variant, minimum, values), replace(knowledge, profiles=tuple(profiles))

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


def _settings(
    made: Sequence[Variant], text: str, seed: int, counts: list[int], starts: int
) -> dict[str, Any]:
    models = [{name: s.reference.hash for name, s in v.systems.items()} for v in made]
    return {
        "format": folders.FORMAT,
        "flexor": version("flexor"),
        "targets": hashlib.sha256(text.encode()).hexdigest(),
        "models": models,
        "options": [dict(v.options) for v in made],
        "seed": seed,
        "samples": counts,
        "starts": starts,
    }
