"""Evaluation on a cluster of machines, with Dask."""

from __future__ import annotations

import pickle
import threading
from collections import deque
from collections.abc import Callable, Generator
from typing import Any, TypeVar
from weakref import WeakKeyDictionary

import numpy as np

from flexor.errors import ClusterError, InputError
from flexor.model import chunks
from flexor.model.results import Paths
from flexor.study.executors import worker
from flexor.study.executors.connection import PATIENCE, Connection
from flexor.study.executors.interface import Executor
from flexor.study.executors.parcel import Parcel, packed
from flexor.study.problem import FloatArray, Problem

Result = TypeVar("Result")
# A task should take no less than this [s], or passing it on takes as long as doing it.
LEAST = 0.02
# Tasks kept waiting for each thread of the cluster, so that none is idle between two.
AHEAD = 3


class Cluster(Executor):
    """Evaluates on the workers of a Dask cluster.

    Each worker is sent the problem once, its model as the text of a model file, and then designs
    as bare numbers. It refuses if it runs another version of Flexor or its model has another hash.
    What a worker that dies was doing is done again by another.

    Parameters
    ----------
    address : str
        Of the scheduler, such as ``"tcp://HOST:8786"``; ``"local:4"`` starts four workers on this
        machine, which end with the executor.
    patience : float
        How long the cluster may be without any worker [s], at first and later.

    Raises
    ------
    InputError
        If Dask is not installed, the address is none, nobody answers there, there are no workers,
        or one of them runs another version of Flexor.

    Notes
    -----
    `parts` raises `flexor.errors.ClusterError` if the cluster is lost; what was evaluated until
    then is in the record of the study. Processes of ``local:N`` import the main module of a
    script, so that a script needs ``if __name__ == "__main__":``.
    """

    def __init__(self, address: str, patience: float = PATIENCE) -> None:
        self._connection = Connection(address, patience)
        self._parcels: WeakKeyDictionary[Problem, Parcel] = WeakKeyDictionary()
        self._spent: dict[str, tuple[int, float]] = {}  # designs and seconds, by token
        self._lock = threading.Lock()

    @property
    def address(self) -> str:
        """As it was given."""
        return self._connection.address.text

    @property
    def slots(self) -> int:
        """Threads of all workers together."""
        return max(self._connection.threads, 1)

    def parts(
        self, problem: Problem, designs: FloatArray, gradient: bool = False
    ) -> Generator[Paths, None, None]:
        """Evaluate designs (n, k) on all workers, in parts of as many as are worth sending.

        Raises
        ------
        InputError
            If a worker refuses the problem.
        ClusterError
            If the cluster is lost.
        """
        parcel = self._sent(problem)
        left = deque(self._split(parcel.token, designs))
        running: deque[tuple[bytes, Any]] = deque()
        try:
            while left or running:
                while left and len(running) < AHEAD * self.slots:
                    work = packed(worker.evaluate, left.popleft(), gradient)
                    running.append((work, self._submit(parcel.token, work)))
                answer = self._answer(parcel, *running.popleft())
                outcomes: Paths = pickle.loads(answer.content)
                self._learn(parcel.token, len(outcomes), answer.seconds)
                yield outcomes
        finally:
            for _, future in running:
                future.release()

    @property
    def away(self) -> bool:
        """True: what it calls sees nothing of this process."""
        return True

    def call(
        self,
        problem: Problem,
        function: Callable[..., Result],
        *arguments: Any,
        stopped: Callable[[], bool] | None = None,
    ) -> Result:
        """Call ``function(problem, *arguments)`` on a worker, and wait for it.

        Raises
        ------
        InputError, ClusterError
            As for `parts`; and what the function raises.
        """
        parcel, work = self._sent(problem), packed(function, *arguments)
        answer = self._answer(parcel, work, self._submit(parcel.token, work), stopped)
        result: Result = pickle.loads(answer.content)
        return result

    def close(self) -> None:
        """Leave the cluster; stop it, if it was started here."""
        self._connection.close()

    def _sent(self, problem: Problem) -> Parcel:
        """Send a problem to every worker there is, the first time."""
        with self._lock:
            known = self._parcels.get(problem)
            if known is not None:
                return known
            parcel = Parcel.of(problem)
            for where, why in self._connection.on_every_worker(worker.install, parcel).items():
                # A worker that dies meanwhile is nobody's fault.
                if why and not isinstance(why, OSError):
                    raise InputError(
                        f'the worker {where} of the cluster "{self.address}" {_reason(why)}.'
                    )
            self._parcels[problem] = parcel
            return parcel

    def _split(self, token: str, designs: FloatArray) -> list[FloatArray]:
        """Split designs for all threads, in parts neither too small nor too large."""
        count, slots = len(designs), self.slots
        parts = -(-count // chunks.SIZE)
        if parts < slots:
            known, seconds = self._spent.get(token, (0, 0.0))
            worth = count if not known else int(count * seconds / known / LEAST)
            parts = max(parts, min(slots, worth, count))
        elif parts < AHEAD * slots:
            parts = -(-parts // slots) * slots  # the same for each thread
        return np.array_split(designs, parts) if parts else []

    def _submit(self, token: str, work: bytes, parcel: Parcel | None = None) -> Any:
        return self._connection.submit(worker.call, token, work, parcel)

    def _answer(
        self,
        parcel: Parcel,
        work: bytes,
        future: Any,
        stopped: Callable[[], bool] | None = None,
    ) -> worker.Answer:
        where = f'the cluster "{self.address}"'
        try:
            answer: worker.Answer = self._connection.result(future, stopped)
        except (ImportError, AttributeError) as error:
            raise InputError(f"a worker of {where} {_reason(error)}.") from error
        except Exception as error:
            if type(error).__name__ != "KilledWorker":
                raise
            raise ClusterError(
                f"{where} lost one worker after another at the same designs: their logs say why, "
                "often for want of memory."
            ) from error
        if answer.error is not None:
            raise answer.error
        if answer.result is None:  # from a worker that came later
            again = self._submit(parcel.token, work, parcel)
            return self._answer(parcel, work, again, stopped)
        return answer

    def _learn(self, token: str, designs: int, seconds: float) -> None:
        """Take in how long designs took."""
        with self._lock:
            count, before = self._spent.get(token, (0, 0.0))
            self._spent[token] = count + designs, before + seconds


def _reason(why: object) -> str:
    if isinstance(why, str):
        return why
    said = " ".join(str(why).split()).rstrip(".")
    return f"has another Flexor, or none: {said}"
