"""Run an optimisation as a study, or resume one."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from flexor.arguments import check_callable, integer
from flexor.design import ParameterSet
from flexor.design.start import starts
from flexor.errors import InputError
from flexor.model.validation import describe
from flexor.objectives import Objective
from flexor.optimizers import (
    Auto,
    Budget,
    Pareto,
    PatternSearch,
    Progress,
    Search,
    SearchResult,
    takes_several,
    uses_gradients,
)
from flexor.optimizers import method as named_method
from flexor.scenarios.scenario import Given
from flexor.store import Database, Kind, Workspace
from flexor.study.dependence import check_problem
from flexor.study.design import Design
from flexor.study.executors import AnyExecutor, DesignEvaluator, chosen_executor
from flexor.study.optimum import save_optimum
from flexor.study.problem import FloatArray, Problem
from flexor.study.recorded_evaluator import RecordedEvaluator
from flexor.study.rounds import run_rounds
from flexor.study.scenario_problem import ScenarioProblem, Uncertainty
from flexor.study.settings import (
    STUDY,
    Settings,
    model_files,
    reopened,
    study_record,
    study_settings,
)
from flexor.study.study import Study, StudyCallback, StudyProgress

if TYPE_CHECKING:
    from flexor.model import Model


def optimize(
    model: Model | str | PathLike[str],
    parameters: str | ParameterSet | Mapping[str, Sequence[object]] = "L+R01",
    objective: str | Objective | Sequence[str | Objective] = "bending",
    method: str | Search | None = None,
    *,
    subject_to: Sequence[str] = (),
    without: Sequence[str] = (),
    scenarios: Given = (),
    aggregate: str = "mean",
    tolerance: Mapping[str, object] | None = None,
    samples: int = 0,
    wearers: int = 0,
    start: ArrayLike | str | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    force: Any = None,
    seed: int = 0,
    budget: int | Budget | None = None,
    folder: str | Path | None = None,
    resume: bool = False,
    progress: StudyCallback | None = None,
    executor: AnyExecutor | None = None,
    finish: Callable[[Study], None] | None = None,
    method_options: Mapping[str, Any] | None = None,
    engine_options: Mapping[str, float] | None = None,
) -> Study:
    """Optimise a design for an objective.

    Parameters
    ----------
    model : Model or path
        The model, or its file, or the name of a preset.
    parameters : str, ParameterSet or dict
        Design parameters: a set, for example ``"L+R01"``, or any numeric fields of the model file
        with their bounds, ``{"exosuit.length": ("8 cm", "12 cm")}``; see `flexor.design.variables`.
    objective : str or Objective, or a sequence of these
        The objective: ``"maximise NAME"`` or ``"minimise NAME"`` of an observable
        (`flexor.observables`), or one of the paper's such as ``"bending"`` (f_b). Of several,
        which conflict, the study has the ``front``.
    method : str or Search, optional
        Search method; by default ``"auto"`` to maximise or minimise an observable, ``"pareto"``
        for several objectives, and otherwise the paper's ``"pattern-search"``.
    subject_to : sequence of str
        Constraints on observables along the whole path, such as ``"overlap <= 0.5 mm"``. Designs
        that keep them come before all others, and these are ordered by how far they exceed them.
    without : sequence of str
        Default constraints that are not to hold, of those of `flexor.constraints`; ``"defaults"``
        for all. They hold when an observable is maximised or minimised.
    scenarios : sequence of str, str, dict or sequence of Scenario, optional
        Variants of the model's file under which each design is evaluated, all of them with
        ``"all"``, and other weights than those of the file as ``{"NAME": 2.0}``; see
        `flexor.scenarios.scenarios`. By default the model as it is.
    aggregate : str
        What the objective's values in the scenarios become: ``"mean"`` (weighted), ``"worst"``,
        ``"quantile 0.9"``, or ``"served 60 deg"``, the share of the scenarios in which the
        objective reaches that and all constraints hold. Otherwise these hold in every scenario.
    tolerance : dict, optional
        Largest errors of fields, ``{"exosuit.section.wall": "0.1 mm"}``, or standard deviations,
        ``"0.1 mm normal"``. Constraints hold for every error within (of a normal one twice its
        deviation).
    samples : int
        Number of errors within the tolerances over which the objective is aggregated as well, a
        Sobol sequence from the seed; with 0 it is that without an error.
    wearers : int
        Number of wearers that are scenarios, drawn from the population that the file states
        (`flexor.scenarios.wearers`) with the seed.
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
        Maximum number of distinct designs to evaluate, or a `Budget`.
    folder : path, optional
        Study folder; in memory by default.
    resume : bool
        Resume the study in ``folder``, whose settings must be these (the budget may differ).
    progress : callable, optional
        Called with a `StudyProgress` after each iteration.
    executor : Threads, concurrent.futures.Executor or str, optional
        Where designs are evaluated: in this process, on all cores, by default. Any
        `concurrent.futures.Executor` can be given (threads, processes, Dask's
        ``client.get_executor()``, ``mpi4py.futures``); a text is the address of a Dask cluster,
        such as ``"tcp://HOST:8786"`` or ``"local:4"``; see `Cluster`.
    finish : callable, optional
        Called with the finished study while its folder is locked, to write files into it.
    method_options, engine_options : dict, optional
        Options of a method given by name, and of the engine's solver.

    Returns
    -------
    Study
        The study, with its ``best`` design and the record of all evaluations.

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
    problem = Problem.of(
        model, parameters, objective, force, bounds, engine_options, subject_to, without
    )
    stated = Uncertainty(
        scenarios,
        aggregate,
        tolerance or {},
        integer("samples", samples, 0),
        integer("wearers", wearers, 0),
    )
    if stated and problem.objective.count:
        raise InputError(
            "scenarios, wearers, tolerances, samples and aggregates need one objective: leave them "
            "out for a front of several."
        )
    if stated:
        problem = ScenarioProblem.over(problem, stated, integer("seed", seed, 0))
    if method is None:
        method = _default_method(problem.objective)
    if not isinstance(method_options, Mapping | None):
        raise InputError(
            f"method_options is {describe(method_options)}: it must be a mapping of options to "
            "values."
        )
    if not isinstance(folder, str | PathLike | None):
        raise InputError(f"folder is {describe(folder)}: it must be a path.")
    if isinstance(method, str):
        search = named_method(method, **(method_options or {}))
    elif method_options:
        raise InputError("options of a method are given with its name, not with a ready method.")
    elif not callable(getattr(method, "minimize", None)):
        raise InputError(
            f"method is {describe(method)}: it must be the name of a method or one of "
            "flexor.optimizers."
        )
    else:
        search = method
    check_objectives(search, problem.objective)
    if not resume:
        check_problem(problem)
    return run_search(
        STUDY,
        problem,
        search,
        start,
        seed=seed,
        budget=budget,
        folder=folder,
        resume=resume,
        progress=progress,
        executor=executor,
        finish=finish,
    )


def resume(
    folder: str | Path,
    *,
    budget: int | Budget | None = None,
    progress: StudyCallback | None = None,
    executor: AnyExecutor | None = None,
    finish: Callable[[Study], None] | None = None,
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
        Replaces the recorded budget.
    progress, executor, finish : optional
        As for `optimize`.
    model, parameters, objective, method : optional
        Override those named in the folder; required if they are user-defined.

    Returns
    -------
    Study
        The study, at the end of its search.

    Raises
    ------
    InputError
        If the folder is not a study, is damaged or in use, or names something not known.
    """
    settings = Settings.read(Path(folder), STUDY)
    return resume_search(
        Path(folder),
        settings,
        reopened(Path(folder), settings, model, parameters, objective),
        method,
        budget=budget,
        progress=progress,
        executor=executor,
        finish=finish,
    )


def resume_search(
    folder: Path,
    settings: Settings,
    problem: Problem,
    search: Search | None = None,
    *,
    budget: int | Budget | None = None,
    **options: Any,
) -> Study:
    """Resume the search of a study or a landscape; for ``options`` see `run_search`."""
    values, recorded = settings.values, settings.values["method"]
    if search is None:
        search = named_method(recorded["name"], **recorded["options"])
    return run_search(
        settings.kind,
        problem,
        search,
        "random" if values["start"] is None else values["start"],
        seed=values["seed"],
        budget=budget if budget is not None else Budget(**values["budget"]),
        folder=folder,
        resume=True,
        **options,
    )


def run_search(
    kind: Kind,
    problem: Problem,
    search: Search,
    start: ArrayLike | str | None = None,
    *,
    seed: int = 0,
    budget: int | Budget | None = None,
    folder: str | Path | None = None,
    resume: bool = False,
    progress: StudyCallback | None = None,
    executor: AnyExecutor | None = None,
    finish: Callable[[Study], None] | None = None,
    planned: Sequence[int | None] = (),
) -> Study:
    """Search a problem in a workspace of this kind; see `optimize`.

    Evaluations are divided among rounds (`flexor.study.rounds`) as in a study that had the
    ``planned`` budgets one after the other; that of a new study is its own unless given.
    """
    limit = budget if isinstance(budget, Budget) else Budget(evaluations=budget)
    seed = integer("seed", seed, 0)
    check_callable("progress", progress)
    check_callable("finish", finish)
    first = _start(problem.parameters, start)
    values = study_settings(problem, search, first, seed, limit)
    files, notes = model_files(problem.model), {"sizes": problem.sizes}
    packages = getattr(search, "packages", ())
    with (
        chosen_executor(executor) as where,
        Workspace(kind, folder, values, files, resume, notes, packages) as work,
    ):
        record = study_record(kind, work.folder, problem, work.database)
        study = Study(problem, Settings(work.settings), record, work.folder)
        best = record.best() if resume else None
        if best is not None:
            found = problem.evaluate(best[None, :]).value
            work.check_reproduces(record.outcomes(best).value, found)
        work.save_settings()
        record.database.note("finished", None)
        run = partial(_search, study, seed=seed, progress=progress, executor=where)
        divided = _planned(record.database, planned, limit.evaluations)
        reason = run_rounds(study, run, search, first, limit, divided)
        record.database.note("finished", reason)
        if kind is STUDY:
            save_optimum(study)
        if finish is not None:
            finish(study)
        return study


def _planned(
    database: Database, planned: Sequence[int | None], given: int | None
) -> list[int | None]:
    """Return and note the budgets that a study had one after the other, each above the last."""
    budgets = list(planned) or database.noted("budgets") or []
    if not planned and (
        not budgets or (budgets[-1] is not None and (given is None or given > budgets[-1]))
    ):
        budgets = [*budgets, given]
    database.note("budgets", budgets)
    return budgets


def _search(
    study: Study,
    search: Search,
    start: FloatArray | None,
    budget: Budget,
    stage: str,
    *,
    seed: int,
    progress: StudyCallback | None,
    executor: DesignEvaluator,
) -> SearchResult:
    """Search a study's problem through its record, from starts (s, k) or, if None, a random one."""
    recorded = RecordedEvaluator(study.problem, study.record, executor, uses_gradients(search))
    began = time.monotonic()
    best: Design | None = None

    def report(at: Progress) -> None:
        nonlocal best
        assert progress is not None
        if np.isfinite(at.value) and (best is None or best.value != at.value):
            best = Design.of(study.problem, at.design, study.record.outcomes(at.design))
        in_budget = None if budget.evaluations is None else budget.evaluations - at.evaluations
        left = [each for each in (at.remaining, in_budget) if each is not None]
        progress(
            StudyProgress(
                best=best,
                evaluations=at.evaluations,
                evaluated=recorded.evaluated,
                replayed=recorded.replayed,
                iteration=at.iteration,
                seconds=time.monotonic() - began,
                remaining=min(left, default=None),
                detail=at.detail,
                stage=stage,
            )
        )

    chosen = study.problem.parameters
    found = search.minimize(
        recorded,
        chosen.lower,
        chosen.upper,
        start=start,
        seed=seed,
        budget=budget,
        progress=report if progress is not None else None,
    )
    study.evaluated += recorded.evaluated
    return found


def check_objectives(search: Search, wanted: Objective) -> None:
    """Refuse a method for one objective if there are several, and the other way round."""
    if takes_several(search) and not wanted.count:
        raise InputError(f"method {search.name} needs several objectives.")
    if wanted.count and not takes_several(search):
        raise InputError(f"method {search.name} takes one objective: pareto takes several.")


def _default_method(wanted: Objective) -> str:
    if wanted.count:
        return Pareto.name
    return Auto.name if wanted.of_observable else PatternSearch.name


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
    try:
        chosen.check_inside(
            designs, "the model's own exosuit as start" if start is None else "start"
        )
    except InputError as error:
        if start is not None:
            raise
        raise InputError(f"{str(error)[:-1]}; give a start within them, or random.") from None
    return designs + 0.0
