"""From what a person gives as executor to one that can be used."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from flexor.study.executors.cluster import Cluster
from flexor.study.executors.interface import Executor
from flexor.study.executors.threads import Threads


@contextmanager
def chosen_executor(given: Executor | str | None) -> Iterator[Executor]:
    """Use an executor while it is needed.

    Parameters
    ----------
    given : Executor, str or None
        An executor, which stays open; the address of a cluster (see `Cluster`), which is left at
        the end; or None for this process, on all cores.

    Yields
    ------
    Executor
        To evaluate with.

    Raises
    ------
    InputError
        If the cluster cannot be used.
    """
    if isinstance(given, str):
        with Cluster(given) as cluster:
            yield cluster
    else:
        yield given if given is not None else Threads()
