"""Where the commands evaluate: threads of this process, or a cluster."""

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
    """Use what `--threads` and `--cluster` ask for.

    Parameters
    ----------
    threads : int
        Of this process; 0 for one per core.
    cluster : str or None
        Address of a cluster to use instead.

    Yields
    ------
    Executor
        While it can be used.

    Raises
    ------
    InputError
        If the cluster cannot be used, or both are given.
    """
    from flexor.study import Threads

    if threads and cluster is not None:
        raise InputError("--threads is of this process and --cluster of others: give one of them.")
    with executor_if(cluster) as found:
        yield Threads(threads) if found is None else found


@contextmanager
def executor_if(cluster: str | None) -> Iterator[Executor | None]:
    """Use the cluster at an address, if there is one.

    Parameters
    ----------
    cluster : str or None
        The address.

    Yields
    ------
    Executor or None
        The cluster while it can be used; None for an address of None.

    Raises
    ------
    InputError
        If the cluster cannot be used.
    """
    if cluster is None:
        yield None
        return
    from flexor.study import Cluster

    with err.status(f"connecting to {cluster}"):
        executor = Cluster(cluster)
    _quieten()
    with executor:
        yield executor


def _quieten() -> None:
    """Have the library log nothing between our lines: what happens is said in sentences."""
    for name in logging.getLogger().manager.loggerDict:
        if name.split(".")[0] in ("distributed", "tornado"):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
