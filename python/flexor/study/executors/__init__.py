"""Executors: where the designs of studies are evaluated."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager

from flexor.errors import InputError
from flexor.study.executors.cluster import Cluster
from flexor.study.executors.interface import DesignEvaluator, Threads
from flexor.study.executors.pool import Pool

__all__ = ["AnyExecutor", "Cluster", "DesignEvaluator", "Pool", "Threads", "chosen_executor"]

AnyExecutor = DesignEvaluator | Executor | str


@contextmanager
def chosen_executor(given: AnyExecutor | None) -> Iterator[DesignEvaluator]:
    """Use an executor, and close what was opened for it.

    None is this process on all cores, a text the address of a cluster; a
    `concurrent.futures.Executor` stays open.
    """
    if given is None:
        yield Threads()
    elif isinstance(given, str):
        with Cluster(given) as cluster:
            yield cluster
    elif isinstance(given, DesignEvaluator):
        yield given
    elif isinstance(given, Executor):
        yield Pool(given)
    else:
        raise InputError(
            f"executor is a {type(given).__name__}: give a concurrent.futures.Executor (of a "
            "Client of Dask, client.get_executor()) or the address of a cluster."
        )
