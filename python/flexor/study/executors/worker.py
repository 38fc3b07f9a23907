"""What the workers of a cluster run.

A worker is sent each problem once, keeps it by its token, and is then sent designs only. It is
asked by functions of plain bytes, which cost the scheduler nothing to pass on.
"""

from __future__ import annotations

import pickle
import threading
import time
from collections import OrderedDict
from dataclasses import dataclass
from importlib.metadata import version

import numpy as np

from flexor.errors import InputError
from flexor.study.problem import Problem

# A worker may serve many studies before it ends; what it has forgotten it is sent again.
_KEPT = 64
_problems: OrderedDict[str, Problem] = OrderedDict()
_lock = threading.Lock()


@dataclass(frozen=True)
class Parcel:
    """A problem on its way to workers.

    Attributes
    ----------
    token : str
        What tasks call it by.
    version : str
        Of the Flexor that sends it.
    content : bytes
        The problem, pickled: its model as the text of a model file.
    """

    token: str
    version: str
    content: bytes


@dataclass(frozen=True)
class Answer:
    """What became of a task.

    Attributes
    ----------
    outcomes : bytes or None
        Outcomes of the designs, pickled; None if there are none.
    seconds : float
        How long they took [s].
    error : Exception or None
        What went wrong; if nothing did, there are no outcomes because the worker does not know the
        problem.
    """

    outcomes: bytes | None
    seconds: float = 0.0
    error: Exception | None = None


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


def evaluate(
    token: str, designs: bytes, parameters: int, gradient: bool, parcel: Parcel | None = None
) -> Answer:
    """Evaluate designs on one thread.

    Parameters
    ----------
    token : str
        Of the problem.
    designs : bytes
        Designs (n, k), float64.
    parameters : int
        Their number k.
    gradient : bool
        Whether to differentiate as well.
    parcel : Parcel, optional
        The problem, for a worker that may not have it.

    Returns
    -------
    Answer
        With the outcomes, or without if the worker does not know the problem. What goes wrong here
        is in it too, so that whatever else a task raises is the cluster's doing.
    """
    if parcel is not None and (why := install(parcel)):
        return Answer(None, error=InputError(f"a worker {why}."))
    with _lock:
        problem = _problems.get(token)
    if problem is None:
        return Answer(None)
    vectors = np.frombuffer(designs, dtype=np.float64).reshape(-1, parameters)
    began = time.perf_counter()
    try:
        outcomes = problem.evaluate(vectors, 1, gradient)
    except Exception as error:
        return Answer(None, error=_portable(error))
    seconds = time.perf_counter() - began
    return Answer(pickle.dumps(outcomes, protocol=5), seconds)


def _portable(error: Exception) -> Exception:
    """Return an error as it is, or in words if it cannot be sent."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error
