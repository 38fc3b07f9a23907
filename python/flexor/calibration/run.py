"""Run or resume a calibration."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np

from flexor.arguments import check_callable, integer
from flexor.calibration.problem import bind_problem
from flexor.calibration.reading import read
from flexor.calibration.record import CALIBRATION, TARGETS, Record
from flexor.calibration.result import Calibration
from flexor.calibration.screening import default_samples
from flexor.calibration.stages import ProgressCallback, Stages
from flexor.model import Model
from flexor.store import Workspace
from flexor.study.executors import AnyExecutor, chosen_executor


def calibrate(
    model: Model,
    targets: str | Path,
    *,
    seed: int = 0,
    samples: int | None = None,
    starts: int | None = None,
    folder: str | Path | None = None,
    resume: bool = False,
    executor: AnyExecutor | None = None,
    progress: ProgressCallback | None = None,
    finish: Callable[[Calibration], None] | None = None,
) -> Calibration:
    """Fit constants of models to targets.

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
    folder : path, optional
        Where to keep the calibration; in memory by default.
    resume : bool
        Resume the calibration in ``folder``, whose settings must be these.
    executor : Threads, concurrent.futures.Executor or str, optional
        Where constants are evaluated, as for `flexor.optimize`; on all cores by default. Results do
        not depend on it.
    progress : callable, optional
        Called with a `Progress` periodically.
    finish : callable, optional
        Called with the calibration while its folder is locked, to write files into it.

    Returns
    -------
    Calibration
        The fits, and the identifiability of the constants.

    Raises
    ------
    InputError
        If the targets file cannot be used, or the folder cannot.

    Notes
    -----
    The ranges are covered evenly (`screening`), the best points start bounded least squares
    (`local_fit`), and the distinct minima are ranked. For the best, local identifiability and
    profile likelihoods are computed (`identifiability`). To resume is to run again with known
    evaluations taken from the record; KeyboardInterrupt leaves a calibration that can be resumed.
    """
    file, text = read(targets)
    problem = bind_problem(file, model, str(targets))
    seed = integer("seed", seed, 0)
    check_callable("progress", progress)
    check_callable("finish", finish)
    starts = file.search.starts if starts is None else integer("starts", starts, 1)
    if samples is None:
        samples = file.search.samples or default_samples(len(problem.constants))
    samples = integer("samples", samples, 1)
    settings = {
        "targets": hashlib.sha256(text.encode()).hexdigest(),
        "models": {name: system.reference.hash for name, system in problem.systems.items()},
        "seed": seed,
        "samples": samples,
        "starts": starts,
    }
    files, packages = {TARGETS: text}, problem.packages
    with (
        chosen_executor(executor) as where,
        Workspace(CALIBRATION, folder, settings, files, resume, packages=packages) as workspace,
    ):
        record = Record(workspace.database)
        if first := record.first():
            (run, _, constants), recorded = first
            x = np.frombuffer(constants, dtype="<f8")[None, :]
            workspace.check_reproduces(recorded, problem.runs[run].evaluate(x)[0])
        stages = Stages(problem, record, where, progress)
        fits, identifiability = stages.analyse(stages.minima(samples, starts, seed))
        found = Calibration(
            title=file.title,
            source=str(targets),
            fits=tuple(fits),
            identifiability=identifiability,
            seed=seed,
            evaluations=len(record),
            folder=workspace.folder,
        )
        if finish is not None:
            finish(found)
        workspace.database.close()
        return found
