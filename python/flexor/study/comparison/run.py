"""Compare methods with the same starts, seeds and budget on each parameter set."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexor.arguments import check_callable, integer
from flexor.design import ParameterSet
from flexor.errors import InputError
from flexor.objectives import Objective, needs_model
from flexor.objectives import objective as named_objective
from flexor.optimizers import LevenbergMarquardt, Search, available, canonical
from flexor.optimizers import method as named_method
from flexor.store import Workspace, open_record, read_settings
from flexor.study.comparison.record import COMPARISON, finished, references
from flexor.study.comparison.result import MethodComparison
from flexor.study.comparison.work import ComparisonCallback, Plan, carry_out
from flexor.study.executors import AnyExecutor, Threads, chosen_executor
from flexor.study.problem import Problem
from flexor.study.settings import (
    at_loads,
    common_settings,
    method_table,
    model_files,
    recorded_constraints,
    recorded_model,
    recorded_set,
    set_table,
)

if TYPE_CHECKING:
    from flexor.model import Model

BUILT_IN_SETS = ("L", "R01", "L+R01", "Rsc", "L+Rsc", "RLP", "L+RLP")
# Not compared unless asked for: a grid does not search, and a surrogate's own work for a design
# takes longer than evaluating hundreds of them. A front is not comparable.
_ASKED_FOR = ("grid", "surrogate", "pareto")


def compare(
    model: Model | str | PathLike[str],
    parameters: str | Sequence[str | ParameterSet] | Mapping[str, Sequence[object]] = BUILT_IN_SETS,
    objective: str | Objective = "bending",
    *,
    subject_to: Sequence[str] = (),
    without: Sequence[str] = (),
    methods: str | Sequence[str] | Mapping[str, Search] | None = None,
    seeds: int | Sequence[int] = 10,
    budget: int = 500,
    force: Any = None,
    known: Mapping[str, float] | None = None,
    folder: str | Path | None = None,
    resume: bool = False,
    progress: ComparisonCallback | None = None,
    executor: AnyExecutor | None = None,
    finish: Callable[[MethodComparison], None] | None = None,
    workers: int = 0,
    engine_options: Mapping[str, float] | None = None,
) -> MethodComparison:
    """Compare search methods.

    Parameters
    ----------
    model, objective, subject_to, without
        As for `flexor.optimize`.
    parameters : str, sequence or dict
        Parameter sets; a text lists them with commas: ``"L,R01"``. By default the built-in ones
        and their unions with the length. Or fields of the model file with their bounds, as for
        `flexor.optimize`.
    methods : str, sequence of str, or mapping of Search, optional
        Methods by name with their default options, or ready ones by label; by default all whose
        libraries are installed and that take the objective, without grid and surrogate.
    seeds : int or sequence of int
        One search for each; a number n means 0 to n - 1. A seed decides the start, the same for
        every method: a random design of the set, or the next if that fails.
    budget : int
        Maximum number of distinct designs per search.
    force, engine_options : optional
        As for `flexor.optimize`.
    known : dict, optional
        Best values known from elsewhere, by set.
    folder : path, optional
        Folder of the comparison; in memory by default.
    resume : bool
        Resume the comparison in ``folder``; sets, methods and seeds may be added to it.
    progress : callable, optional
        Called with a `ComparisonProgress` periodically.
    executor : Threads, concurrent.futures.Executor or str, optional
        Where designs are evaluated; on one thread for each search by default. What
        `flexor.optimize` takes; the workers of a pool of processes or a cluster do whole searches.
    finish : callable, optional
        Called with the comparison while its folder is locked, to write files into it.
    workers : int
        Concurrent searches; 0 for one per core, or per thread of the cluster. The results do not
        depend on it, but times may.

    Returns
    -------
    MethodComparison
        Every search, with summaries; `performance_profiles` and `data_profiles` take it.

    Raises
    ------
    InputError
        If a name is not known, a library is missing, an objective is not the norm of a vector
        where a method needs that, or the folder cannot be used.
    """
    problems = _problems(model, parameters, objective, force, engine_options, subject_to, without)
    plan = Plan(
        problems=problems,
        methods=_methods(methods, next(iter(problems.values())).objective),
        seeds=_seeds(seeds),
        budget=integer("budget", budget, 1),
    )
    return _compare(plan, known, folder, resume, progress, executor, finish, workers)


def _compare(
    plan: Plan,
    known: Mapping[str, float] | None,
    folder: str | Path | None,
    resume: bool,
    progress: ComparisonCallback | None,
    executor: AnyExecutor | None,
    finish: Callable[[MethodComparison], None] | None,
    workers: int,
) -> MethodComparison:
    workers = integer("workers", workers, 0)
    check_callable("progress", progress)
    check_callable("finish", finish)
    plan.check()
    files = model_files(plan.problem.model)
    with (
        chosen_executor(executor if executor is not None else Threads(1)) as where,
        Workspace(
            COMPARISON, folder, _settings(plan), files, resume, packages=plan.packages
        ) as work,
    ):
        found = carry_out(plan, work, known or {}, progress, where, workers)
        if finish is not None:
            finish(found)
        work.database.close()
        return found


def resume_comparison(
    folder: str | Path,
    *,
    known: Mapping[str, float] | None = None,
    progress: ComparisonCallback | None = None,
    executor: AnyExecutor | None = None,
    finish: Callable[[MethodComparison], None] | None = None,
    workers: int = 0,
) -> MethodComparison:
    """Resume a comparison from its folder.

    Parameters
    ----------
    folder : path
        The comparison's folder.
    known, progress, executor, finish, workers : optional
        As for `compare`.

    Returns
    -------
    MethodComparison
        The whole comparison.

    Raises
    ------
    InputError
        If the folder is not a comparison, is damaged or in use, or names something not known.
    """
    place = Path(folder)
    values = read_settings(COMPARISON, place)
    model = recorded_model(place)
    wanted = at_loads(named_objective(values["objective"]["name"], model), values, model)
    kept = recorded_constraints(values["constraints"], model)
    sets = {name: recorded_set(name, table, model) for name, table in values["sets"].items()}
    plan = Plan(
        problems={
            name: Problem(model, chosen.on_model(model), wanted, values["engine"], kept)
            for name, chosen in sets.items()
        },
        methods={
            label: named_method(method["name"], **method["options"])
            for label, method in values["methods"].items()
        },
        seeds=tuple(values["seeds"]),
        budget=values["budget"],
    )
    return _compare(plan, known, place, True, progress, executor, finish, workers)


def open_comparison(
    folder: str | Path, *, known: Mapping[str, float] | None = None
) -> MethodComparison:
    """Read a finished comparison of any version from its folder.

    Parameters
    ----------
    folder : path
        The comparison's folder.
    known : dict, optional
        As for `compare`.

    Returns
    -------
    MethodComparison
        The whole comparison.

    Raises
    ------
    InputError
        If the folder is not a comparison, is damaged or not finished, or names an objective that
        is not known.
    """
    values = read_settings(COMPARISON, Path(folder))
    name = values["objective"]["name"]
    model = recorded_model(Path(folder)) if needs_model(name) else None
    wanted = named_objective(name, model).at(values["objective"]["force"])
    with closing(open_record(COMPARISON, Path(folder), write=False)) as database:
        runs, reference = finished(database), references(database)
    keys = [
        (s, m, seed) for s in values["sets"] for m in values["methods"] for seed in values["seeds"]
    ]
    if missing := sum(key not in runs for key in keys):
        raise InputError(
            f'the comparison "{folder}" lacks {missing} of {len(keys)} searches: resume it.'
        )
    return MethodComparison(
        model=values["model"]["name"],
        objective=wanted,
        budget=values["budget"],
        sets={name: len(limits["labels"]) for name, limits in values["sets"].items()},
        methods=tuple(values["methods"]),
        seeds=tuple(values["seeds"]),
        reference=reference,
        runs=tuple(runs[key] for key in keys),
        known=dict(known or {}),
    )


def _problems(
    model: Model | str | PathLike[str],
    parameters: str | Sequence[str | ParameterSet] | Mapping[str, Sequence[object]],
    objective: str | Objective,
    force: Any,
    engine_options: Mapping[str, float] | None,
    subject_to: Sequence[str],
    without: Sequence[str],
) -> dict[str, Problem]:
    problems: dict[str, Problem] = {}
    listed: Sequence[Any] = [parameters]
    if not isinstance(parameters, Mapping):
        listed = _listed(parameters, "parameter set")
    for each in listed:
        problem = Problem.of(
            model,
            each,
            objective,
            force,
            options=engine_options,
            subject_to=subject_to,
            without=without,
        )
        name = problem.parameters.name
        if name in problems:
            raise InputError(f'the parameter set "{name}" is given twice.')
        problems[name] = problem
    return problems


def _methods(
    methods: str | Sequence[str] | Mapping[str, Search] | None, wanted: Objective
) -> dict[str, Search]:
    if isinstance(methods, Mapping):
        if not methods:
            raise InputError("give at least one method to compare.")
        return dict(methods)
    if methods is None:
        methods = [name for name in available() if name not in _ASKED_FOR]
        if not wanted.is_norm:
            methods = [name for name in methods if name != LevenbergMarquardt.name]
    chosen: dict[str, Search] = {}
    for name in map(canonical, _listed(methods, "method")):
        if name in chosen:
            raise InputError(f'the method "{name}" is given twice.')
        chosen[name] = named_method(name)
    return chosen


def _listed(given: str | Sequence[Any], what: str) -> list[Any]:
    parts = [part.strip() for part in given.split(",")] if isinstance(given, str) else list(given)
    parts = [part for part in parts if part != ""]
    if not parts:
        raise InputError(f"give at least one {what} to compare.")
    return parts


def _seeds(seeds: int | Sequence[int]) -> tuple[int, ...]:
    if isinstance(seeds, str) or not isinstance(seeds, Iterable):
        return tuple(range(integer("seeds", seeds, 1)))
    chosen = tuple(integer("a seed", seed, 0) for seed in seeds)
    if not chosen or len(set(chosen)) < len(chosen):
        raise InputError(f"seeds must be distinct non-negative integers, got {list(seeds)}.")
    return chosen


def _settings(plan: Plan) -> dict[str, Any]:
    return {
        **common_settings(plan.problem),
        "budget": plan.budget,
        "sets": {name: set_table(each.parameters) for name, each in plan.problems.items()},
        "methods": {label: method_table(search) for label, search in plan.methods.items()},
        "seeds": list(plan.seeds),
    }
