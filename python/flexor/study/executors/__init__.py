"""Executors: where the designs of studies are evaluated."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor as StandardExecutor
from contextlib import contextmanager

from flexor.errors import InputError
from flexor.study.executors.cluster import Cluster
from flexor.study.executors.interface import Executor, Threads
from flexor.study.executors.pool import Pool

__all__ = ["AnyExecutor", "Cluster", "Executor", "Pool", "Threads", "chosen_executor"]

AnyExecutor = Executor | StandardExecutor | str


@contextmanager
def chosen_executor(given: AnyExecutor | None) -> Iterator[Executor]:
    """Use an executor, and close what was opened for it.

    None is this process on all cores, a text the address of a cluster; anything with the interface
    of `concurrent.futures.Executor` stays open.
    """
    if given is None:
        yield Threads()
    elif isinstance(given, str):
        with Cluster(given) as cluster:
            yield cluster
    elif isinstance(given, Executor):
        yield given
    elif callable(getattr(given, "submit", None)):
        yield Pool(given)
    else:
        raise InputError(
            f"executor is a {type(given).__name__}: give the address of a cluster, or something "
            "with the interface of concurrent.futures.Executor."
        )
