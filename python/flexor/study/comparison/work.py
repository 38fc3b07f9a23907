"""The searches of a comparison, several at a time, each through a record of its own."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Generator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexor.errors import InputError
from flexor.model.interruption import cancel_solves
from flexor.optimizers import (
    Budget,
    LevenbergMarquardt,
    Search,
    SearchResult,
    starting_designs,
    uses_gradients,
)
from flexor.store import Workspace
from flexor.study.comparison.record import Key, finished, references, running_record, save
from flexor.study.comparison.result import MethodComparison, SearchRun
from flexor.study.executors import DesignEvaluator, Threads
from flexor.study.optimization import check_objectives
from flexor.study.problem import FloatArray, Problem
from flexor.study.record import Record
from flexor.study.recorded_evaluator import RecordedEvaluator

# Random designs tried for a start that does not fail.
_TRIES = 64


@dataclass(frozen=True, eq=False)
class Plan:
    """What is to be compared: each method on each problem, once for each seed."""

    problems: Mapping[str, Problem]  # by parameter set
    methods: Mapping[str, Search]  # by label
    seeds: tuple[int, ...]
    budget: int  # evaluations of each search

    @property
    def problem(self) -> Problem:
        """Any of the problems, which differ in their parameters alone."""
        return next(iter(self.problems.values()))

    @property
    def packages(self) -> set[str]:
        """Packages whose versions decide the results."""
        return {name for each in self.methods.values() for name in getattr(each, "packages", ())}

    def check(self) -> None:
        """Refuse an objective that a method does not take."""
        for search in self.methods.values():
            check_objectives(search, self.problem.objective)
        if self.problem.objective.count:
            raise InputError("methods are compared on one objective, not on several.")
        if any(isinstance(search, LevenbergMarquardt) for search in self.methods.values()):
            start = self.problem.parameters.start[None, :]
            self.problem.residuals(self.problem.evaluate(start))


@dataclass(frozen=True)
class ComparisonProgress:
    """Progress of a running comparison."""

    done: int  # searches
    total: int  # searches
    evaluations: int  # designs evaluated now
    seconds: float  # time since it began or was resumed [s]
    last: str  # description of the search that ended last

    @property
    def rate(self) -> float:
        """Designs evaluated per second."""
        return self.evaluations / self.seconds if self.seconds > 0.0 else 0.0


ComparisonCallback = Callable[[ComparisonProgress], None]


class _Stopped(BaseException):
    """Raised within searches when the comparison is to stop."""


class _Tally:
    """Designs evaluated by all searches, and whether they are to stop."""

    def __init__(self) -> None:
        self.evaluations = 0
        self.stopped = False
        self._lock = threading.Lock()

    def add(self, count: int) -> None:
        """Count designs."""
        with self._lock:
            self.evaluations += count

    def check(self) -> None:
        """End the search of this thread if all are to stop."""
        if self.stopped:
            raise _Stopped


class _CountedEvaluator(RecordedEvaluator):
    """The recorded function of one search, which counts for all and can be stopped."""

    def __init__(self, tally: _Tally, *arguments: Any) -> None:
        super().__init__(*arguments)
        self._tally = tally

    def stream(
        self, designs: FloatArray, part: int | None = None
    ) -> Generator[FloatArray, None, None]:
        """Yield values of designs (n, k), part after part."""
        self._tally.check()
        before = self.evaluated
        for values in super().stream(designs, part):
            self._tally.add(self.evaluated - before)
            before = self.evaluated
            self._tally.check()
            yield values


@dataclass(frozen=True, eq=False)
class SearchTask:
    """A search to be done, which can be sent to a worker."""

    search: Search
    start: FloatArray  # (1, k)
    seed: int
    budget: int

    def run(self, problem: Problem, function: RecordedEvaluator) -> SearchResult:
        """Search a problem through its recorded function."""
        return self.search.minimize(
            function,
            problem.parameters.lower,
            problem.parameters.upper,
            start=self.start,
            seed=self.seed,
            budget=Budget(evaluations=self.budget),
        )


def search_in_memory(problem: Problem, task: SearchTask) -> tuple[SearchResult, float]:
    """Search with a record in memory, on one thread; return how long that took as well [s]."""
    began, record = time.monotonic(), Record(None, problem.sizes)
    gradients = uses_gradients(task.search)
    try:
        result = task.run(problem, RecordedEvaluator(problem, record, Threads(1), gradients))
    finally:
        record.close()
    return result, time.monotonic() - began


def carry_out(
    plan: Plan,
    work: Workspace,
    known: Mapping[str, float],
    progress: ComparisonCallback | None,
    executor: DesignEvaluator,
    workers: int,
) -> MethodComparison:
    """Run every search of a plan that has not finished yet, ``workers`` at a time.

    With 0 workers they are as many as the executor evaluates at a time; ``known`` are the best
    values of sets known from elsewhere.
    """
    began, tally = time.monotonic(), _Tally()
    kept = finished(work.database)
    # Seed by seed, so that an interrupted comparison covers every set and method.
    keys = [(s, m, seed) for seed in plan.seeds for s in plan.problems for m in plan.methods]
    runs = {key: kept[key] for key in keys if key in kept}
    missing = [key for key in keys if key not in kept]
    reference = _references(plan, work)
    work.save_settings()
    starts = {
        name: _starts(problem, plan.seeds, executor)
        for name, problem in plan.problems.items()
        if any(key[0] == name for key in missing)
    }
    last = ""

    def report() -> None:
        if progress is not None:
            seconds = time.monotonic() - began
            progress(ComparisonProgress(len(runs), len(keys), tally.evaluations, seconds, last))

    def search(key: Key) -> SearchRun:
        tally.check()
        task = SearchTask(plan.methods[key[1]], starts[key[0]][key[2]], key[2], plan.budget)
        result, seconds = _search(plan.problems[key[0]], key, task, work, executor, tally)
        run = SearchRun(*key, result, seconds)
        save(work.database, run)
        return run

    report()
    with ThreadPoolExecutor(workers or executor.slots) as pool:
        waiting: set[Future[SearchRun]] = set()
        try:
            waiting = {pool.submit(search, key) for key in missing}
            while waiting:
                ended, waiting = wait(waiting, timeout=0.2, return_when=FIRST_COMPLETED)
                for future in ended:
                    run = future.result()
                    runs[run.parameters, run.method, run.seed] = run
                    last = f"{run.parameters}, {run.method}, seed {run.seed}"
                report()
        except BaseException as error:
            tally.stopped = True
            if isinstance(error, KeyboardInterrupt):
                cancel_solves(waiting)
            pool.shutdown(wait=False, cancel_futures=True)
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
    """Evaluate each set's own start: its rank, which must be that which is known."""
    kept = references(work.database)
    found = {
        name: float(problem.ranks(problem.evaluate(problem.parameters.start[None, :]))[0])
        for name, problem in plan.problems.items()
    }
    known = [name for name in found if name in kept]
    work.check_reproduces([kept[name] for name in known], [found[name] for name in known])
    work.database.note("reference", {**kept, **found})
    return found


def _starts(
    problem: Problem, seeds: tuple[int, ...], executor: DesignEvaluator
) -> dict[int, FloatArray]:
    """Draw the start of each seed: its first random design that does not fail, (1, k)."""
    lower, upper = problem.parameters.lower, problem.parameters.upper
    random = {seed: np.random.default_rng(seed) for seed in seeds}
    starts: dict[int, FloatArray] = {}
    drawing = list(seeds)
    for _ in range(_TRIES):
        drawn = [starting_designs(None, 1, lower, upper, random[seed]) for seed in drawing]
        good = np.isfinite(executor.evaluate(problem, np.concatenate(drawn)).value).tolist()
        for seed, design, found in zip(drawing, drawn, good, strict=True):
            if found or seed not in starts:
                starts[seed] = design
        drawing = [seed for seed, found in zip(drawing, good, strict=True) if not found]
        if not drawing:
            break
    return starts


def _search(
    problem: Problem,
    key: Key,
    task: SearchTask,
    work: Workspace,
    executor: DesignEvaluator,
    tally: _Tally,
) -> tuple[SearchResult, float]:
    """Search; return how long that took as well [s], NaN if it was interrupted on the way."""
    if executor.remote:
        # As one task: it would ask for too few designs at a time to be worth sending.
        result, seconds = executor.call(
            problem, search_in_memory, task, stopped=lambda: tally.stopped
        )
        tally.add(result.evaluations)
        return result, seconds
    began, record = time.monotonic(), running_record(work.database, problem, key)
    function = _CountedEvaluator(tally, problem, record, executor, uses_gradients(task.search))
    result = task.run(problem, function)
    return result, time.monotonic() - began if function.replayed == 0 else np.nan
