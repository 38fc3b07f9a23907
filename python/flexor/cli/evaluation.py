"""Executors selected on the command line: local threads or a cluster."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from flexor.cli.console import err
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor.study import Executor


@contextmanager
def executor_for(threads: int, cluster: str | None) -> Iterator[Executor]:
    """Provide the executor selected by `--threads` and `--cluster`.

    Parameters
    ----------
    threads : int
        Number of threads of this process; 0 for one per core.
    cluster : str or None
        Address of a cluster to use instead.

    Yields
    ------
    Executor
        The executor, for the duration of the context.

    Raises
    ------
    InputError
        If the cluster is not available, or both are given.
    """
    from flexor.study import Threads

    if threads and cluster is not None:
        raise InputError("--threads and --cluster exclude each other: give one of them.")
    with executor_if(cluster) as found:
        yield Threads(threads) if found is None else found


@contextmanager
def executor_if(cluster: str | None) -> Iterator[Executor | None]:
    """Connect to the cluster at an address, if one is given.

    Parameters
    ----------
    cluster : str or None
        The address.

    Yields
    ------
    Executor or None
        The cluster, for the duration of the context; None without an address.

    Raises
    ------
    InputError
        If the cluster is not available.
    """
    if cluster is None:
        yield None
        return
    from flexor.study import Cluster

    with err.status(f"connecting to {cluster}"):
        executor = Cluster(cluster)
    _silence_logging()
    with executor:
        yield executor


def _silence_logging() -> None:
    """Suppress the logs of Dask; errors are reported as exceptions."""
    for name in logging.getLogger().manager.loggerDict:
        if name.split(".")[0] in ("distributed", "tornado"):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
