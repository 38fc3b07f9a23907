"""What is sent to other processes: a function, its arguments, and the problem they are about."""

from __future__ import annotations

import pickle
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from flexor.errors import InputError
from flexor.model.results import Paths
from flexor.store.environment import decisive_versions
from flexor.study.problem import FloatArray, Problem


@dataclass(frozen=True)
class PickledProblem:
    """A problem as bytes: 5 kB for the finger, which go with every task.

    Its model is pickled as the text of a model file, a user's own functions by value where they
    have no module and cloudpickle is installed.
    """

    content: bytes
    versions: tuple[tuple[str, str], ...]  # Flexor and engine of the sender

    @classmethod
    def of(cls, problem: object) -> PickledProblem:
        """Pickle a problem."""
        try:
            content = dumps(problem)
        except Exception as error:
            raise InputError(
                f"{problem} cannot be sent to other processes: {one_line(error)}."
            ) from error
        return cls(content, tuple(decisive_versions().items()))


@dataclass(frozen=True)
class Reply:
    """The outcome of a task."""

    result: Any = None
    seconds: float = 0.0
    # What the function raised: part of the reply, so that anything else raised while waiting
    # is the executor's own.
    error: Exception | None = None


def run(problem: PickledProblem, work: bytes) -> Reply:
    """Call a function of a problem; ``work`` is that and further arguments, from `dumps`."""
    try:
        function, arguments = pickle.loads(work)
        return call(_unpickled(problem), function, arguments)
    except InputError as error:
        return Reply(error=error)
    except Exception as error:
        # A user's function may import what is missing here.
        return Reply(error=InputError(f"a worker cannot load the problem: {one_line(error)}."))


def call(problem: object, function: Callable[..., Any], arguments: tuple[Any, ...]) -> Reply:
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
    """Return how Flexor differs here from the version that asks; empty if it does not."""
    here = decisive_versions()
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


@lru_cache(maxsize=64)  # a process may serve many studies before it ends
def _unpickled(pickled: PickledProblem) -> object:
    if differs := check(dict(pickled.versions)):
        raise InputError(f"a worker {differs}.")
    problem: object = pickle.loads(pickled.content)
    return problem


def _portable(error: Exception) -> Exception:
    """Return an error as it is, or in words if it cannot be pickled."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error
