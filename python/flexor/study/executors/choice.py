"""From what a person gives as executor to one that can be used."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor as StandardExecutor
from contextlib import contextmanager

from flexor.errors import InputError
from flexor.study.executors.cluster import Cluster
from flexor.study.executors.interface import Executor
from flexor.study.executors.pool import Pool
from flexor.study.executors.threads import Threads

AnyExecutor = Executor | StandardExecutor | str


@contextmanager
def chosen_executor(given: AnyExecutor | None) -> Iterator[Executor]:
    """Use an executor while it is needed.

    Parameters
    ----------
    given : Executor, concurrent.futures.Executor, str or None
        An executor, or anything with the interface of `concurrent.futures.Executor`, which stays
        open; the address of a cluster (see `Cluster`), which is left at the end; or None for this
        process, on all cores.

    Yields
    ------
    Executor
        To evaluate with.

    Raises
    ------
    InputError
        If it is none of these, or the cluster cannot be used.
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
