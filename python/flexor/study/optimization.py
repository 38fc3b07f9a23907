"""Run an optimisation as a study, or go on with one."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from flexor.design import ParameterSet, parameter_set
from flexor.design.start import bounds_in_si, starts
from flexor.errors import InputError
from flexor.model.loading import require_model
from flexor.model.loads import evaluation_forces
from flexor.objectives import Objective
from flexor.objectives import objective as named_objective
from flexor.optimizers import Budget, Search
from flexor.optimizers import method as named_method
from flexor.store import Workspace
from flexor.study.executors import AnyExecutor, chosen_executor
from flexor.study.problem import FloatArray, Problem
from flexor.study.progress import StudyCallback
from flexor.study.reopen import reopened, reopened_record
from flexor.study.run import run
from flexor.study.settings import MODEL, STUDY, Settings, study_settings
from flexor.study.study import Study

if TYPE_CHECKING:
    from flexor.model import Model


def optimize(
    model: Model,
    parameters: str | ParameterSet = "L+R01",
    objective: str | Objective = "bending",
    method: str | Search = "pattern-search",
    *,
    start: ArrayLike | str | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    force: Any = None,
    seed: int = 0,
    budget: int | Budget | None = None,
    folder: str | Path | None = None,
    resume: bool = False,
    progress: StudyCallback | None = None,
    executor: AnyExecutor | None = None,
    method_options: Mapping[str, Any] | None = None,
    engine_options: Mapping[str, float] | None = None,
) -> Study:
    """Optimise a design for an objective.

    Parameters
    ----------
    model : Model
        The model, with a ``[design]``.
    parameters : str or ParameterSet
        What may be changed, for example ``"L+R01"``.
    objective : str or Objective
        What is minimised, for example ``"bending"`` (f_b).
    method : str or Search
        How.
    start : (k,) or (s, k) array, str or list of str, optional
        Where the search begins, SI, or texts such as ``"10 cm, 0.7 cm"`` or ``"R_0=0.7 cm"``;
        the parameter set's own start (the model's exosuit) by default, and drawn from the seed if
        ``"random"``.
    bounds : dict, optional
        Other bounds by label, SI or texts with a unit.
    force : (steps,) array, str or dict, optional
        Actuation forces [N], as for `Model.equilibrium`, of which the last counts; by default the
        objective's or the model's.
    seed : int
        Random seed.
    budget : int or Budget, optional
        Distinct designs to evaluate at most, or a `Budget`.
    folder : path, optional
        Where to keep the study; in memory by default.
    resume : bool
        Resume the study in ``folder``, whose settings must be these (the budget may differ).
    progress : callable, optional
        Called with a `StudyProgress` after each iteration.
    executor : Threads, concurrent.futures.Executor or str, optional
        Where designs are evaluated: in this process, on all cores, by default. Anything with the
        interface of `concurrent.futures.Executor` can be given (threads, processes, Dask's
        ``client.get_executor()``, ``mpi4py.futures``); a text is the address of a Dask cluster,
        such as ``"tcp://HOST:8786"`` or ``"local:4"``; see `Cluster`.
    method_options, engine_options : dict, optional
        Options of a method given by name, and of the engine's solver.

    Returns
    -------
    Study
        Its ``best`` design and the record of all.

    Raises
    ------
    InputError
        If a name is not known, a start lies outside the bounds, or the folder or the cluster
        cannot be used.
    ClusterError
        If the cluster is lost on the way; a study in a folder can be resumed.

    Notes
    -----
    Each batch is recorded before the search sees its values. Resuming is running the search again
    with known designs answered from the record: a process that was killed loses the batch it was
    in. KeyboardInterrupt passes through and leaves a study that can be resumed.
    """
    chosen = parameter_set(parameters, require_model(model).design)
    chosen = chosen.on(model.design)
    if bounds:
        chosen = chosen.with_bounds(bounds_in_si(bounds, chosen))
    wanted = named_objective(objective)
    if force is not None:
        wanted = wanted.at(evaluation_forces(force, require_model(model).input_dimensions))
    if isinstance(method, str):
        search = named_method(method, **(method_options or {}))
    elif method_options:
        raise InputError("options of a method are given with its name, not with a ready method.")
    else:
        search = method
    limit = budget if isinstance(budget, Budget) else Budget(evaluations=budget)
    problem = Problem(model, chosen, wanted, dict(engine_options or {}))
    first = _start(chosen, start)
    values = study_settings(problem, search, first, seed, limit)
    files = {MODEL: model.file.to_toml()}
    with (
        chosen_executor(executor) as where,
        Workspace(STUDY, folder, values, files, resume, {"sizes": problem.sizes}) as work,
    ):
        work.check_versions()
        record = reopened_record(work.folder, problem, work.database)
        study = Study(problem, Settings(work.settings), record, work.folder)
        if resume:
            _check_reproduces(study)
            work.save_settings()
        record.note("finished", None)
        study.result = run(study, search, first, seed, limit, progress, where)
        record.note("finished", study.result.reason)
        return study


def resume(
    folder: str | Path,
    *,
    budget: int | Budget | None = None,
    progress: StudyCallback | None = None,
    executor: AnyExecutor | None = None,
    model: Model | None = None,
    parameters: ParameterSet | None = None,
    objective: Objective | None = None,
    method: Search | None = None,
) -> Study:
    """Resume a study from its folder.

    Parameters
    ----------
    folder : path
        The study folder.
    budget : int or Budget, optional
        In place of the one it was begun with.
    progress, executor : optional
        As for `optimize`.
    model, parameters, objective, method : optional
        In place of those that the folder names; needed for a user's own.

    Returns
    -------
    Study
        The study, at the end of its search.

    Raises
    ------
    InputError
        If the folder is not a study, is damaged or in use, or names something not known.
    """
    place = Path(folder)
    settings = Settings.read(place)
    values = settings.values
    problem = reopened(place, settings, model, parameters, objective)
    return optimize(
        problem.model,
        problem.parameters,
        problem.objective,
        method if method is not None else values["method"]["name"],
        start="random" if values["start"] is None else values["start"],
        seed=values["seed"],
        budget=budget if budget is not None else Budget(**values["budget"]),
        folder=place,
        resume=True,
        progress=progress,
        executor=executor,
        method_options=None if method is not None else values["method"]["options"],
        engine_options=problem.options,
    )


def _start(chosen: ParameterSet, start: ArrayLike | str | None) -> FloatArray | None:
    texts = [start] if isinstance(start, str) else start
    if isinstance(texts, (list, tuple)) and texts and all(isinstance(t, str) for t in texts):
        start = starts(list(texts), chosen, "start")
        if start == "random":
            return None
    try:
        given = np.asarray(chosen.start if start is None else start, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError("start must be numbers in SI units or texts with units.") from None
    designs: FloatArray = np.atleast_2d(given)
    chosen.check_inside(designs, "the model's own exosuit as start" if start is None else "start")
    return designs + 0.0


def _check_reproduces(study: Study) -> None:
    """Refuse to resume if a recorded design no longer gives what was recorded.

    The settings cannot tell whether a user's own set or objective is still the same function.
    """
    vector = study.record.best()
    if vector is None:
        return
    recorded = study.record.outcomes(vector).value[0]
    found = study.problem.evaluate(vector[None, :]).value[0]
    if not np.isclose(found, recorded, rtol=1e-9, atol=1e-12):
        raise InputError(
            f'the study "{study.folder}" recorded {recorded:.9g} for its best design, which now '
            f"gives {found:.9g}: its objective, parameter set or engine has changed."
        )
