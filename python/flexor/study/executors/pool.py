"""Evaluation on any `concurrent.futures.Executor`."""

from __future__ import annotations

import os
import threading
from collections import deque
from collections.abc import Callable, Generator
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor, wait
from typing import Any, TypeVar
from weakref import WeakKeyDictionary

import numpy as np

from flexor.errors import ClusterError, InputError
from flexor.model import chunks
from flexor.model.interruption import cancel_solves
from flexor.model.results import Paths
from flexor.study.executors import task
from flexor.study.executors.interface import DesignEvaluator
from flexor.study.executors.task import PickledProblem, Reply, one_line
from flexor.study.problem import FloatArray, Problem

Result = TypeVar("Result")
# Shorter tasks [s] would take as long to send as to do.
MIN_TASK_SECONDS = 0.02
# Tasks submitted per worker, so that none is idle between two.
QUEUE_DEPTH = 3
# Seconds between checks that the executor is alive while waiting for it.
_POLL_INTERVAL = 0.2


class Pool(DesignEvaluator):
    """Evaluates with a `concurrent.futures.Executor`.

    Threads of this process get the problem itself; other processes get it pickled with each task
    and unpickle it once.

    Parameters
    ----------
    executor : concurrent.futures.Executor
        For example a ``ProcessPoolExecutor``, Dask's ``client.get_executor()`` or an
        ``MPIPoolExecutor`` of mpi4py. It stays open.
    name : str
        Name for messages.

    Notes
    -----
    Evaluating raises `InputError` if the problem cannot be sent or a worker refuses it, and
    `flexor.errors.ClusterError` if the executor is lost.
    """

    def __init__(self, executor: Executor, name: str = "the executor") -> None:
        self._executor, self._name = executor, name
        self._here = isinstance(executor, ThreadPoolExecutor)
        self._pickled: WeakKeyDictionary[object, PickledProblem] = WeakKeyDictionary()
        self._spent: WeakKeyDictionary[Problem, tuple[int, float]] = WeakKeyDictionary()
        self._lock = threading.Lock()

    @property
    def slots(self) -> int:
        """How many workers the executor says that it has; else the number of cores."""
        found: Any = self._executor
        client = getattr(found, "_client", None)  # of Dask
        if client is not None:
            return max(int(sum(client.nthreads().values())), 1)
        workers = getattr(found, "_max_workers", None) or getattr(found, "num_workers", None)
        return int(workers or os.cpu_count() or 1)

    def parts(
        self, problem: Problem, designs: FloatArray, gradient: bool = False
    ) -> Generator[Paths, None, None]:
        """Evaluate designs (n, k) on all workers, in parts of as many as are worth sending."""
        left = deque(self._split(problem, designs))
        running: deque[Future[Reply]] = deque()
        try:
            while left or running:
                while left and len(running) < QUEUE_DEPTH * self.slots:
                    running.append(self._submit(problem, task.evaluate, left.popleft(), gradient))
                reply = self._reply(running.popleft())
                outcomes: Paths = reply.result
                self._note_time(problem, len(outcomes), reply.seconds)
                yield outcomes
        except KeyboardInterrupt:
            if self._here:
                cancel_solves(running)
            raise
        finally:
            for future in running:
                future.cancel()

    @property
    def remote(self) -> bool:
        """Whether the workers are other processes."""
        return not self._here

    def call(
        self,
        problem: object,
        function: Callable[..., Result],
        *arguments: Any,
        stopped: Callable[[], bool] | None = None,
    ) -> Result:
        """Call ``function(problem, *arguments)`` on a worker, and wait for it."""
        result: Result = self._reply(self._submit(problem, function, *arguments), stopped).result
        return result

    def _submit(
        self, problem: object, function: Callable[..., Any], *arguments: Any
    ) -> Future[Reply]:
        work: tuple[Any, ...] = (task.call, problem, function, arguments)
        if not self._here:
            with self._lock:
                pickled = self._pickled.get(problem)
                if pickled is None:
                    pickled = self._pickled[problem] = PickledProblem.of(problem)
            work = (task.run, pickled, task.dumps((function, arguments)))
        future: Future[Reply] = self._guarded(self._executor.submit, *work)
        return future

    def _reply(self, future: Future[Reply], stopped: Callable[[], bool] | None = None) -> Reply:
        """Wait for a reply."""
        while not wait([future], _POLL_INTERVAL).done:
            if stopped is not None and stopped():
                future.cancel()
                raise CancelledError
            self._check_alive()
        reply: Reply = self._guarded(future.result)
        if reply.error is not None:
            raise reply.error
        return reply

    def _check_alive(self) -> None:
        """Raise ClusterError if there is nothing to wait for any more."""

    def _guarded(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Call something of the executor; if that fails, the executor is lost."""
        try:
            return function(*arguments)
        except (ImportError, AttributeError) as error:
            raise InputError(
                f"a worker of {self._name} has another Flexor, or none: {one_line(error)}."
            ) from error
        except (Exception, CancelledError) as error:
            raise ClusterError(f"{self._name} was lost: {self._why(error)}.") from error

    def _why(self, error: BaseException) -> str:
        """Return why the executor was lost, as the end of a sentence."""
        return one_line(error)

    def _split(self, problem: Problem, designs: FloatArray) -> list[FloatArray]:
        """Split designs for all workers, in parts neither too small nor too large."""
        count, slots = len(designs), self.slots
        parts = -(-count // chunks.SIZE)
        if parts < slots:
            known, seconds = self._spent.get(problem, (0, 0.0))
            worth = count if not known else int(count * seconds / known / MIN_TASK_SECONDS)
            parts = max(parts, min(slots, worth, count))
        elif parts < QUEUE_DEPTH * slots:
            parts = -(-parts // slots) * slots  # the same for each worker
        return np.array_split(designs, parts) if parts else []

    def _note_time(self, problem: Problem, designs: int, seconds: float) -> None:
        """Note how long designs took."""
        with self._lock:
            count, before = self._spent.get(problem, (0, 0.0))
            self._spent[problem] = count + designs, before + seconds
