"""Run or resume a calibration."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from flexor.calibration.calibration import Calibration
from flexor.calibration.combine import variants
from flexor.calibration.explore import default_samples
from flexor.calibration.progress import ProgressCallback
from flexor.calibration.reading import read
from flexor.calibration.record import CALIBRATION, TARGETS, Record
from flexor.calibration.variant import Variant
from flexor.calibration.work import Work
from flexor.model import Model
from flexor.store import Workspace


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
    progress: ProgressCallback | None = None,
) -> Calibration:
    """Find the constants with which models meet their targets.

    Parameters
    ----------
    model : Model
        The model that is calibrated; the targets file may name more that share its constants.
    targets : path
        The targets file.
    seed : int
        Random seed.
    samples, starts : int, optional
        Points of the global search and how many of them are refined; the file's, or else by the
        number of constants.
    chosen : dict, optional
        Options by choice, where not all are to be tried.
    folder : path, optional
        Where to keep the calibration; in memory by default.
    resume : bool
        Resume the calibration in ``folder``, whose settings must be these.
    threads : int
        0 for one per core. Results do not depend on it.
    progress : callable, optional
        Called with a `Progress` now and then.

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
    with Workspace(CALIBRATION, folder, settings, {TARGETS: text}, resume) as held:
        held.check_versions()
        record = Record(held.database)
        work = Work(record, made, threads, progress)
        if resume:
            work.check_reproduces()
        minima = [work.minima(i, counts[i], starts, seed) for i in range(len(made))]
        fits, knowledge = work.judged(minima)
        held.database.close()
        return Calibration(
            title=file.title,
            source=str(targets),
            fits=tuple(fits),
            knowledge=knowledge,
            seed=seed,
            evaluations=len(record),
            folder=held.folder,
        )


def _settings(
    made: Sequence[Variant], text: str, seed: int, counts: list[int], starts: int
) -> dict[str, Any]:
    models = [{name: s.reference.hash for name, s in v.systems.items()} for v in made]
    return {
        "targets": hashlib.sha256(text.encode()).hexdigest(),
        "models": models,
        "options": [dict(v.options) for v in made],
        "seed": seed,
        "samples": counts,
        "starts": starts,
    }
