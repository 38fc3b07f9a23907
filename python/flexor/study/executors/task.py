"""What is sent to other processes: a function, its arguments, and the problem they are about."""

from __future__ import annotations

import hashlib
import pickle
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from flexor.errors import InputError
from flexor.model.results import Paths
from flexor.store.environment import decisive
from flexor.study.problem import FloatArray, Problem

# A process may serve many studies before it ends.
_KEPT = 64
_problems: OrderedDict[str, Problem] = OrderedDict()
_lock = threading.Lock()


@dataclass(frozen=True)
class PickledProblem:
    """A problem as bytes: 5 kB for the finger, which go with every task.

    Attributes
    ----------
    token : str
        A hash of the bytes, by which a process knows the problem again.
    content : bytes
        The problem, pickled: its model as the text of a model file, a user's own functions by
        value where they have no module and cloudpickle is installed.
    versions : dict of str
        Flexor and engine of the sender.
    """

    token: str
    content: bytes
    versions: Mapping[str, str]

    @classmethod
    def of(cls, problem: Problem) -> PickledProblem:
        """Pickle a problem.

        Raises
        ------
        InputError
            If its parameter set or its objective cannot be pickled.
        """
        try:
            content = dumps(problem)
        except Exception as error:
            raise InputError(
                f'parameter set "{problem.parameters.name}" or objective '
                f'"{problem.objective.name}" cannot be sent to other processes: {one_line(error)}.'
            ) from error
        return cls(hashlib.sha256(content).hexdigest()[:16], content, decisive())


@dataclass(frozen=True)
class Reply:
    """What became of a task.

    Attributes
    ----------
    result : Any
        What the function returned.
    seconds : float
        How long it took [s].
    error : Exception or None
        What it raised. It is part of the reply so that whatever else waiting for a task raises is
        the executor's own.
    """

    result: Any = None
    seconds: float = 0.0
    error: Exception | None = None


def run(problem: PickledProblem, work: bytes) -> Reply:
    """Call a function of a problem, as pickled by `dumps` with its further arguments.

    Parameters
    ----------
    problem : PickledProblem
        The first argument, unpickled only where it is not known yet.
    work : bytes
        Function and further arguments.
    """
    try:
        function, arguments = pickle.loads(work)
        return call(_unpickled(problem), function, arguments)
    except InputError as error:
        return Reply(error=error)
    except Exception as error:
        # What users' own functions import may be missing here.
        return Reply(error=InputError(f"a worker cannot load the problem: {one_line(error)}."))


def call(problem: Problem, function: Callable[..., Any], arguments: tuple[Any, ...]) -> Reply:
    """Call a function of a problem."""
    began = time.perf_counter()
    try:
        return Reply(function(problem, *arguments), time.perf_counter() - began)
    except Exception as error:
        return Reply(error=_portable(error))


def evaluate(problem: Problem, designs: FloatArray, gradient: bool) -> Paths:
    """Evaluate designs (n, k) on one thread: a worker has one for each task."""
    return problem.evaluate(designs, 1, gradient)


def check(wanted: Mapping[str, str]) -> str:
    """Say in what Flexor differs here from the one that asks; empty if in nothing."""
    here = decisive()
    if here["flexor"] != wanted["flexor"]:
        return f"runs Flexor {here['flexor']}, this is {wanted['flexor']}: install the same version"
    if here != dict(wanted):
        return "runs another build of the engine than this process: install the same package"
    return ""


def dumps(value: Any) -> bytes:
    """Pickle, functions that have no module by value where cloudpickle is installed."""
    try:
        import cloudpickle as pickler
    except ImportError:
        pickler = pickle
    content: bytes = pickler.dumps(value, protocol=5)
    return content


def one_line(error: BaseException) -> str:
    """Return what an exception says, as the end of a sentence."""
    return " ".join(str(error).split()).rstrip(".") or type(error).__name__


def _unpickled(pickled: PickledProblem) -> Problem:
    with _lock:
        if pickled.token in _problems:
            _problems.move_to_end(pickled.token)
            return _problems[pickled.token]
    if differs := check(pickled.versions):
        raise InputError(f"a worker {differs}.")
    problem: Problem = pickle.loads(pickled.content)
    with _lock:
        _problems[pickled.token] = problem
        while len(_problems) > _KEPT:
            _problems.popitem(last=False)
    return problem


def _portable(error: Exception) -> Exception:
    """Return an error as it is, or in words if it cannot be pickled."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error
