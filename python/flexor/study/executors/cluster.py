"""Evaluation on a cluster of machines, with Dask."""

from __future__ import annotations

import hashlib
import pickle
import threading
from collections import deque
from collections.abc import Generator
from importlib.metadata import version
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from flexor.errors import ClusterError, InputError
from flexor.study.executors import worker
from flexor.study.executors.connection import PATIENCE, Connection
from flexor.study.executors.interface import PART, Executor
from flexor.study.outcomes import FloatArray, Outcomes
from flexor.study.problem import Problem

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
        self._parcels: WeakKeyDictionary[Problem, worker.Parcel] = WeakKeyDictionary()
        self._spent: dict[str, tuple[int, float]] = {}  # designs and seconds, by token
        self._lock = threading.Lock()

    @property
    def slots(self) -> int:
        """Threads of all workers together."""
        return max(self._connection.threads, 1)

    def parts(
        self, problem: Problem, designs: FloatArray, gradient: bool = False
    ) -> Generator[Outcomes, None, None]:
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
        running: deque[tuple[FloatArray, Any]] = deque()
        try:
            while left or running:
                while left and len(running) < AHEAD * self.slots:
                    part = left.popleft()
                    running.append((part, self._submit(parcel.token, part, gradient)))
                part, future = running.popleft()
                yield self._outcomes(parcel, part, gradient, future)
        finally:
            for _, future in running:
                future.release()

    def close(self) -> None:
        """Leave the cluster; stop it, if it was started here."""
        self._connection.close()

    def _sent(self, problem: Problem) -> worker.Parcel:
        """Send a problem to every worker there is, the first time."""
        with self._lock:
            known = self._parcels.get(problem)
            if known is not None:
                return known
            parcel = _parcel(problem)
            for where, why in self._connection.on_every_worker(worker.install, parcel).items():
                # A worker that dies meanwhile is nobody's fault.
                if why and not isinstance(why, OSError):
                    raise InputError(
                        f'the worker {where} of the cluster "{self._connection.address.text}" '
                        f"{_reason(why)}."
                    )
            self._parcels[problem] = parcel
            return parcel

    def _split(self, token: str, designs: FloatArray) -> list[FloatArray]:
        """Split designs for all threads, in parts neither too small nor too large."""
        count, slots = len(designs), self.slots
        parts = -(-count // PART)
        if parts < slots:
            known, seconds = self._spent.get(token, (0, 0.0))
            worth = count if not known else int(count * seconds / known / LEAST)
            parts = max(parts, min(slots, worth, count))
        elif parts < AHEAD * slots:
            parts = -(-parts // slots) * slots  # the same for each thread
        return np.array_split(designs, parts) if parts else []

    def _submit(
        self, token: str, part: FloatArray, gradient: bool, parcel: worker.Parcel | None = None
    ) -> Any:
        content = np.ascontiguousarray(part, dtype=np.float64).tobytes()
        return self._connection.submit(
            worker.evaluate, token, content, part.shape[1], gradient, parcel
        )

    def _outcomes(
        self, parcel: worker.Parcel, part: FloatArray, gradient: bool, future: Any
    ) -> Outcomes:
        answer = self._answer(future)
        if answer.outcomes is None:  # from a worker that came later
            answer = self._answer(self._submit(parcel.token, part, gradient, parcel))
        assert answer.outcomes is not None
        with self._lock:
            count, seconds = self._spent.get(parcel.token, (0, 0.0))
            self._spent[parcel.token] = count + len(part), seconds + answer.seconds
        found: Outcomes = pickle.loads(answer.outcomes)
        return found

    def _answer(self, future: Any) -> worker.Answer:
        where = self._connection.address.text
        try:
            answer: worker.Answer = self._connection.result(future)
        except (ImportError, AttributeError) as error:
            raise InputError(f'a worker of the cluster "{where}" {_reason(error)}.') from error
        except Exception as error:
            if type(error).__name__ != "KilledWorker":
                raise
            raise ClusterError(
                f'the cluster "{where}" lost one worker after another at the same designs: their '
                "logs say why, often for want of memory."
            ) from error
        if answer.error is not None:
            raise answer.error
        return answer


def _parcel(problem: Problem) -> worker.Parcel:
    import cloudpickle

    try:
        content: bytes = cloudpickle.dumps(problem, protocol=5)
    except Exception as error:
        raise InputError(
            f'parameter set "{problem.parameters.name}" or objective "{problem.objective.name}" '
            f"cannot be sent to a cluster: {' '.join(str(error).split()).rstrip('.')}."
        ) from error
    return worker.Parcel(hashlib.sha256(content).hexdigest()[:16], version("flexor"), content)


def _reason(why: object) -> str:
    if isinstance(why, str):
        return why
    said = " ".join(str(why).split()).rstrip(".")
    return f"has another Flexor, or none: {said}"
