"""Searches of the studio, which end when nobody listens any more."""

from __future__ import annotations

import os
import queue
import threading
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.errors import InputError
from flexor.optimizers import Budget, method, names
from flexor.study.executors import Threads
from flexor.study.optimization import run_search
from flexor.study.settings import STUDY

if TYPE_CHECKING:
    from flexor.studio.workbench import Workbench
    from flexor.study import Design, Study, StudyProgress

MAX_BUDGET = 1_000_000


class _Stopped(Exception):
    """The listener is gone."""


def methods() -> list[str]:
    """Return the names of search methods."""
    return list(names())


def search(
    bench: Workbench,
    values: Sequence[float],
    loads: Sequence[float],
    name: str,
    budget: int,
    seed: int,
) -> Iterator[dict[str, Any]]:
    """Yield the progress of a search from a design, and at last its end.

    Closing the iterator ends the search at its next iteration.

    Parameters
    ----------
    bench
        The workbench.
    values, loads
        The start, as for `Workbench.solve`.
    name
        The method.
    budget
        Number of designs.
    seed
        Random seed.

    Yields
    ------
    dict
        First of the start and then of the best design so far: ``values`` in units for display,
        ``shown``, ``feasible``, ``evaluations``, ``rate`` [1/s], and in the end ``ended``, the
        reason.

    Raises
    ------
    InputError
        If the method or a number is not known.
    """
    problem, start = bench.problem_at(loads), bench.vector(values)
    chosen = method(name)
    if not 1 <= budget <= MAX_BUDGET:
        raise InputError(f"budget is {budget}: at least 1 and at most {MAX_BUDGET:,} designs.")
    found: queue.Queue[dict[str, Any] | BaseException] = queue.Queue()
    stopped = threading.Event()

    def row(best: Design | None, evaluations: int) -> dict[str, Any]:
        if best is None or not np.isfinite(best.shown):
            return {"values": None, "shown": None, "feasible": False, "evaluations": evaluations}
        return {
            "values": (best.vector / problem.parameters.scale).tolist(),
            "shown": best.shown,
            "feasible": best.feasible,
            "evaluations": evaluations,
        }

    def progress(at: StudyProgress) -> None:
        if stopped.is_set():
            raise _Stopped
        found.put({**row(at.best, at.evaluations), "rate": at.rate})

    def run() -> None:
        try:
            study: Study = run_search(
                STUDY,
                problem,
                chosen,
                start,
                seed=seed,
                budget=Budget(evaluations=budget),
                progress=progress,
                executor=Threads(max(1, (os.cpu_count() or 2) - 1)),
            )
            found.put({**row(study.best, study.evaluations), "ended": study.finished})
            study.close()
        except _Stopped:
            pass
        except BaseException as error:
            found.put(error)

    at_start = problem.evaluate(start[None, :], 1)
    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    try:
        yield {
            "values": (start / problem.parameters.scale).tolist(),
            "shown": float(at_start.shown[0]) if np.isfinite(at_start.shown[0]) else None,
            "feasible": not at_start.violation[0] > 0.0,
            "evaluations": 0,
        }
        while True:
            try:
                each = found.get(timeout=0.5)
            except queue.Empty:
                yield {}  # finds out whether anybody listens
                continue
            if isinstance(each, BaseException):
                raise each
            yield each
            if "ended" in each:
                return
    finally:
        stopped.set()
