"""The searches of a comparison, several at a time, each through a record of its own."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Generator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexor.model.interruption import end_all
from flexor.optimizers import LevenbergMarquardt, Search, SearchResult, starting_designs
from flexor.store import Workspace
from flexor.study.comparison.record import finished, running_record, save
from flexor.study.comparison.result import MethodComparison, SearchRun
from flexor.study.comparison.search import SearchTask, search_in_memory
from flexor.study.executors import Executor
from flexor.study.problem import FloatArray, Problem
from flexor.study.record import Record
from flexor.study.recorded_evaluator import RecordedEvaluator

# Random designs tried for a start that does not fail.
_TRIES = 64


@dataclass(frozen=True, eq=False)
class Plan:
    """What is to be compared.

    Attributes
    ----------
    problems : dict of Problem
        By parameter set.
    methods : dict of Search
        By label.
    seeds : tuple of int
        One search of each method on each set for each.
    budget : int
        Evaluations of each search.
    """

    problems: Mapping[str, Problem]
    methods: Mapping[str, Search]
    seeds: tuple[int, ...]
    budget: int

    @property
    def problem(self) -> Problem:
        """Any of the problems: model, objective and loads are the same in all."""
        return next(iter(self.problems.values()))

    def check(self) -> None:
        """Refuse at once what the last of a hundred searches would have refused.

        Raises
        ------
        InputError
            If a method needs the norm of a vector and the objective is not one.
        """
        if any(isinstance(search, LevenbergMarquardt) for search in self.methods.values()):
            start = self.problem.parameters.start[None, :]
            self.problem.residuals(self.problem.evaluate(start))


@dataclass(frozen=True)
class ComparisonProgress:
    """Where a comparison stands.

    Attributes
    ----------
    done, total : int
        Searches.
    evaluations : int
        Designs evaluated now.
    seconds : float
        Since it began or was resumed.
    last : str
        The search that ended last, in words.
    """

    done: int
    total: int
    evaluations: int
    seconds: float
    last: str

    @property
    def rate(self) -> float:
        """Designs evaluated per second."""
        return self.evaluations / self.seconds if self.seconds > 0.0 else 0.0


ComparisonCallback = Callable[[ComparisonProgress], None]


class _Stopped(BaseException):
    """Raised within searches when the comparison is to stop."""


class _Watched(RecordedEvaluator):
    """The recorded function of one search, which counts for all and can be stopped."""

    def __init__(
        self, problem: Problem, record: Record, executor: Executor, gradients: bool, tally: _Tally
    ) -> None:
        super().__init__(problem, record, executor, gradients)
        self._tally = tally

    def stream(
        self, designs: FloatArray, part: int | None = None
    ) -> Generator[FloatArray, None, None]:
        """Yield values of designs (n, k), part after part."""
        if self._tally.stop.is_set():
            raise _Stopped
        before = self.evaluated
        for values in super().stream(designs, part):
            self._tally.add(self.evaluated - before)
            before = self.evaluated
            if self._tally.stop.is_set():
                raise _Stopped
            yield values


class _Tally:
    """Designs evaluated by all searches, and whether they are to stop."""

    def __init__(self) -> None:
        self.stop = threading.Event()
        self.evaluations = 0
        self._lock = threading.Lock()

    def add(self, count: int) -> None:
        """Count designs."""
        with self._lock:
            self.evaluations += count


def carry_out(
    plan: Plan,
    work: Workspace,
    known: Mapping[str, float],
    progress: ComparisonCallback | None,
    executor: Executor,
    workers: int,
) -> MethodComparison:
    """Run every search of a plan that has not finished yet.

    Parameters
    ----------
    plan : Plan
        What is compared.
    work : Workspace
        Where searches are kept.
    known : dict
        Best values known from elsewhere, by set.
    progress : callable or None
        Called now and then.
    executor : Executor
        Where designs are evaluated.
    workers : int
        Searches at a time; 0 for as many as the executor evaluates at a time.

    Returns
    -------
    MethodComparison
        Once all have ended.

    Raises
    ------
    InputError
        If there is something left to do and the folder was begun by another version.
    """
    began, tally = time.monotonic(), _Tally()
    kept = finished(work.database)
    # Seed by seed: stopped early, a comparison has something of everything.
    keys = [(s, m, seed) for seed in plan.seeds for s in plan.problems for m in plan.methods]
    runs = {key: kept[key] for key in keys if key in kept}
    missing = [key for key in keys if key not in kept]
    if missing:
        work.check_versions()
    work.save_settings()
    reference = _references(plan, work)
    starts = {
        name: _starts(problem, plan.seeds, executor)
        for name, problem in plan.problems.items()
        if any(key[0] == name for key in missing)
    }
    total, last = len(runs) + len(missing), ""

    def tell() -> None:
        if progress is not None:
            seconds = time.monotonic() - began
            progress(ComparisonProgress(len(runs), total, tally.evaluations, seconds, last))

    tell()
    with ThreadPoolExecutor(workers or executor.slots) as pool:
        waiting: set[Future[SearchRun]] = set()
        try:
            for key in missing:
                start = starts[key[0]][key[2]]
                waiting.add(pool.submit(_search, plan, key, start, work, executor, tally))
            while waiting:
                ended, waiting = wait(waiting, timeout=0.2, return_when=FIRST_COMPLETED)
                for future in ended:
                    run = future.result()
                    runs[run.parameters, run.method, run.seed] = run
                    last = f"{run.parameters}, {run.method}, seed {run.seed}"
                tell()
        except BaseException as error:
            tally.stop.set()
            if isinstance(error, KeyboardInterrupt):
                end_all(waiting)
            for future in waiting:
                future.cancel()
            raise
    return MethodComparison(
        model=plan.problem.model.name,
        objective=plan.problem.objective,
        budget=plan.budget,
        sets={name: problem.parameters.size for name, problem in plan.problems.items()},
        methods=tuple(plan.methods),
        seeds=plan.seeds,
        reference=reference,
        runs=tuple(
            runs[s, m, seed] for s in plan.problems for m in plan.methods for seed in plan.seeds
        ),
        known=dict(known),
    )


def _references(plan: Plan, work: Workspace) -> dict[str, float]:
    """Return values of each set's own start; kept, so a finished comparison evaluates nothing."""
    kept = work.database.noted("reference")
    known: dict[str, Any] = dict(kept) if isinstance(kept, dict) else {}
    for name, problem in plan.problems.items():
        if not isinstance(known.get(name), float):
            known[name] = float(problem.evaluate(problem.parameters.start[None, :]).value[0])
        elif np.isnan(known[name]):
            raise work.database.damaged(f"the reference of {name} is no number")
    if known != kept:
        work.database.note("reference", known)
    return {name: known[name] for name in plan.problems}


def _starts(problem: Problem, seeds: tuple[int, ...], executor: Executor) -> dict[int, FloatArray]:
    """Draw the start of each seed: its first random design that does not fail, (1, k)."""
    lower, upper = problem.parameters.lower, problem.parameters.upper
    random = {seed: np.random.default_rng(seed) for seed in seeds}
    starts: dict[int, FloatArray] = {}
    drawing = list(seeds)
    for _ in range(_TRIES):
        drawn = [starting_designs(None, 1, lower, upper, random[seed]) for seed in drawing]
        good = np.isfinite(executor.evaluate(problem, np.concatenate(drawn)).value)
        for seed, design, found in zip(drawing, drawn, good.tolist(), strict=True):
            if found or seed not in starts:
                starts[seed] = design
        drawing = [seed for seed, found in zip(drawing, good.tolist(), strict=True) if not found]
        if not drawing:
            break
    return starts


def _search(
    plan: Plan,
    key: tuple[str, str, int],
    start: FloatArray,
    work: Workspace,
    executor: Executor,
    tally: _Tally,
) -> SearchRun:
    parameters, method, seed = key
    problem = plan.problems[parameters]
    if tally.stop.is_set():
        raise _Stopped
    task = SearchTask(plan.methods[method], start, seed, plan.budget)
    if executor.remote:
        # As one task: it would ask for too few designs at a time to be worth sending.
        result, seconds = executor.call(problem, search_in_memory, task, stopped=tally.stop.is_set)
        tally.add(result.evaluations)
    else:
        record = running_record(work.database, problem, key)
        result, seconds = _recorded(problem, task, record, executor, tally)
    run = SearchRun(parameters, method, seed, result, seconds)
    save(work.database, run)
    return run


def _recorded(
    problem: Problem, task: SearchTask, record: Record, executor: Executor, tally: _Tally
) -> tuple[SearchResult, float]:
    """Search, keeping every design at once; return how long that took as well [s]."""
    began = time.monotonic()
    function = _Watched(problem, record, executor, task.gradients, tally)
    result = task.run(problem, function)
    return result, time.monotonic() - began if function.replayed == 0 else np.nan
