"""What the workers of a cluster run.

A worker is sent each problem once, keeps it by its token, and is then sent designs only. What goes
to and fro is plain bytes, which cost the scheduler nothing to look at.
"""

from __future__ import annotations

import pickle
import threading
import time
from collections import OrderedDict
from dataclasses import dataclass
from importlib.metadata import version

from flexor.errors import InputError
from flexor.model.results import Paths
from flexor.study.executors.parcel import Parcel
from flexor.study.problem import FloatArray, Problem

# A worker may serve many studies before it ends; what it has forgotten it is sent again.
_KEPT = 64
_problems: OrderedDict[str, Problem] = OrderedDict()
_lock = threading.Lock()


@dataclass(frozen=True)
class Answer:
    """What became of a task.

    Attributes
    ----------
    result : bytes or None
        What the function returned, pickled; None if it did not.
    seconds : float
        How long it took [s].
    error : Exception or None
        What went wrong; if nothing did, there is no result because the worker does not know the
        problem.
    """

    result: bytes | None
    seconds: float = 0.0
    error: Exception | None = None

    @property
    def content(self) -> bytes:
        """The result that there is."""
        assert self.result is not None
        return self.result


def install(parcel: Parcel) -> str:
    """Take in a problem.

    Parameters
    ----------
    parcel : Parcel
        The problem.

    Returns
    -------
    str
        Empty, or why this worker cannot have it: the end of a sentence about the worker.
    """
    with _lock:
        if parcel.token in _problems:
            _problems.move_to_end(parcel.token)
            return ""
    if (here := version("flexor")) != parcel.version:
        return f"runs Flexor {here}, this is {parcel.version}"
    try:
        problem = pickle.loads(parcel.content)
    except InputError as error:
        return f"refuses the problem: {str(error).rstrip('.')}"
    except Exception as error:
        # What users' own functions import may be missing there, or anything else.
        return f"cannot load the problem: {' '.join(str(error).split()).rstrip('.')}"
    with _lock:
        _problems[parcel.token] = problem
        while len(_problems) > _KEPT:
            _problems.popitem(last=False)
    return ""


def call(token: str, work: bytes, parcel: Parcel | None = None) -> Answer:
    """Call a function of a problem.

    Parameters
    ----------
    token : str
        Of the problem.
    work : bytes
        Function and further arguments, pickled.
    parcel : Parcel, optional
        The problem, for a worker that may not have it.

    Returns
    -------
    Answer
        With the result, or without if the worker does not know the problem. What goes wrong here
        is in it too, so that whatever else a task raises is the cluster's doing.
    """
    if parcel is not None and (why := install(parcel)):
        return Answer(None, error=InputError(f"a worker {why}."))
    with _lock:
        problem = _problems.get(token)
    if problem is None:
        return Answer(None)
    try:
        function, arguments = pickle.loads(work)
        began = time.perf_counter()
        result = function(problem, *arguments)
        seconds = time.perf_counter() - began
        return Answer(pickle.dumps(result, protocol=5), seconds)
    except Exception as error:
        return Answer(None, error=_portable(error))


def evaluate(problem: Problem, designs: FloatArray, gradient: bool) -> Paths:
    """Evaluate designs (n, k) on one thread: a worker has one for each task."""
    return problem.evaluate(designs, 1, gradient)


def _portable(error: Exception) -> Exception:
    """Return an error as it is, or in words if it cannot be sent."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error
