"""Compare methods with the same starts, seeds and budget on each parameter set."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexor.arguments import check_callable, integer
from flexor.design import ParameterSet, parameter_set
from flexor.errors import InputError
from flexor.objectives import Objective
from flexor.objectives import objective as named_objective
from flexor.optimizers import Search, available, canonical
from flexor.optimizers import method as named_method
from flexor.store import Workspace, open_record, read_settings
from flexor.study.comparison.record import COMPARISON, finished, references
from flexor.study.comparison.result import MethodComparison
from flexor.study.comparison.work import ComparisonCallback, Plan, carry_out
from flexor.study.executors import AnyExecutor, Threads, chosen_executor
from flexor.study.problem import Problem
from flexor.study.settings import (
    MODEL,
    common_settings,
    limits_table,
    method_table,
    recorded_model,
    within_limits,
)

if TYPE_CHECKING:
    from flexor.model import Model

BUILT_IN_SETS = ("L", "R01", "L+R01", "Rsc", "L+Rsc", "RLP", "L+RLP")
# Not compared unless asked for: a grid does not search, and a surrogate's own work for a design
# takes longer than evaluating hundreds of them.
_ASKED_FOR = ("grid", "surrogate")


def compare(
    model: Model,
    parameters: str | Sequence[str | ParameterSet] = BUILT_IN_SETS,
    objective: str | Objective = "bending",
    *,
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
    model, objective : Model, str or Objective
        As for `flexor.optimize`.
    parameters : str or sequence
        Parameter sets; a text lists them with commas: ``"L,R01"``. By default the built-in ones
        and their unions with the length.
    methods : str, sequence of str, or mapping of Search, optional
        Methods by name with their default options, or ready ones by label; by default all whose
        libraries are installed, without grid and surrogate.
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
    workers = integer("workers", workers, 0)
    check_callable("progress", progress)
    check_callable("finish", finish)
    plan = Plan(
        problems=_problems(model, parameters, objective, force, engine_options),
        methods=_methods(methods),
        seeds=_seeds(seeds),
        budget=integer("budget", budget, 1),
    )
    plan.check()
    files = {MODEL: model.file.to_toml()}
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
    return compare(
        model,
        [
            within_limits(parameter_set(name, model.design), limits)
            for name, limits in values["sets"].items()
        ],
        values["objective"]["name"],
        methods={
            label: named_method(method["name"], **method["options"])
            for label, method in values["methods"].items()
        },
        seeds=values["seeds"],
        budget=values["budget"],
        force=values["objective"]["force"],
        known=known,
        folder=place,
        resume=True,
        progress=progress,
        executor=executor,
        finish=finish,
        workers=workers,
        engine_options=values["engine"],
    )


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
    wanted = named_objective(values["objective"]["name"]).at(values["objective"]["force"])
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
    model: Model,
    parameters: str | Sequence[str | ParameterSet],
    objective: str | Objective,
    force: Any,
    engine_options: Mapping[str, float] | None,
) -> dict[str, Problem]:
    problems: dict[str, Problem] = {}
    for each in _listed(parameters, "parameter set"):
        problem = Problem.of(model, each, objective, force, options=engine_options)
        name = problem.parameters.name
        if name in problems:
            raise InputError(f'the parameter set "{name}" is given twice.')
        problems[name] = problem
    return problems


def _methods(methods: str | Sequence[str] | Mapping[str, Search] | None) -> dict[str, Search]:
    if isinstance(methods, Mapping):
        if not methods:
            raise InputError("give at least one method to compare.")
        return dict(methods)
    if methods is None:
        methods = [name for name in available() if name not in _ASKED_FOR]
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
        "sets": {name: limits_table(each.parameters) for name, each in plan.problems.items()},
        "methods": {label: method_table(search) for label, search in plan.methods.items()},
        "seeds": list(plan.seeds),
    }
