"""A Dask cluster, by its address: one that runs, or one started on this machine."""

from __future__ import annotations

import logging
import re
import time
from concurrent.futures import CancelledError, ThreadPoolExecutor
from contextlib import ExitStack, suppress
from typing import Any

from flexor.errors import ClusterError, InputError
from flexor.installing import install_command
from flexor.store.environment import decisive_versions
from flexor.study.executors import task
from flexor.study.executors.local_cluster import LocalCluster
from flexor.study.executors.pool import Pool
from flexor.study.executors.task import one_line

# Time for a scheduler to answer, to leave after an interruption, and for workers to appear [s].
CONNECT_TIMEOUT = 10.0
INTERRUPT_TIMEOUT = 0.3
WORKER_TIMEOUT = 60.0
_NO_ANSWER = "its scheduler no longer answers"
# How long a count of threads stays valid [s].
_COUNT_TTL = 5.0
# More processes than this on one machine are almost certainly a mistake.
MOST_LOCAL = 1024
_REMOTE = re.compile(
    r"(tcp|tls|ws|wss)://(\[[0-9A-Fa-f:.]+\]|[\w.-]+):(?P<port>[0-9]{1,5})/?", re.ASCII
)


def local_workers(address: str) -> int:
    """Return the number of workers that ``local:N`` asks for, 0 for ``tcp://HOST:PORT``."""
    kind, _, rest = address.partition(":")
    if kind == "local" and not rest.startswith("//"):
        count = int(rest) if re.fullmatch(r"[0-9]{1,6}", rest, re.ASCII) else -1
        if not 1 <= count <= MOST_LOCAL:
            raise InputError(
                f'the cluster "{address}" cannot be started: expected "local:N", N from 1 to '
                f"{MOST_LOCAL}."
            )
        return count
    match = _REMOTE.fullmatch(address)
    if match is None:
        raise InputError(
            f'the cluster "{address}" is not an address: give that of a Dask scheduler, such as '
            '"tcp://HOST:8786", or "local:N" for N workers on this machine.'
        )
    if not 1 <= int(match["port"]) <= 65535:
        raise InputError(
            f'the cluster "{address}" has port {match["port"]}: ports are from 1 to 65535.'
        )
    return 0


class Cluster(Pool):
    """Evaluates on the workers of a Dask cluster.

    The tasks of a worker that dies are repeated by another.

    Parameters
    ----------
    address : str
        Address of the scheduler, such as ``"tcp://HOST:8786"``; ``"local:4"`` starts four workers
        on this machine, which end with the executor.
    patience : float
        How long the cluster may be without any worker [s], at first and later.

    Raises
    ------
    InputError
        If Dask is not installed, the address is invalid, no scheduler answers, there are no
        workers, or one of them runs another version of Flexor or another build of its engine.

    Notes
    -----
    `parts` raises `flexor.errors.ClusterError` if the cluster is lost; what was evaluated until
    then is in the record of the study. Processes of ``local:N`` import the main module of a
    script, so that a script needs ``if __name__ == "__main__":``.
    """

    def __init__(self, address: str, patience: float = WORKER_TIMEOUT) -> None:
        self.address = address.strip()
        name, workers = f'the cluster "{self.address}"', local_workers(self.address)
        self._patience = patience
        self._opened = ExitStack()
        self._local: LocalCluster | None = None
        self._close_timeout = CONNECT_TIMEOUT  # [s]
        self._client: Any = None
        self._threads, self._counted = 0, -_COUNT_TTL
        self._without_workers_since: float | None = None
        distributed = _library()
        # Its client logs broken connections, which are reported as exceptions here.
        log = logging.getLogger("distributed.client")
        self._opened.callback(log.setLevel, log.level)
        log.setLevel(logging.CRITICAL + 1)
        try:
            client = self._connect(distributed, name, workers)
            super().__init__(client.get_executor(), name)
            self._wait_for_workers()
            self._check_workers()
        except BaseException as error:
            self.__exit__(error)
            raise

    @property
    def slots(self) -> int:
        """Threads of all workers together."""
        return max(self._count(), 1)

    def close(self) -> None:
        """Leave the cluster; stop it, if it was started here."""
        self._opened.close()

    def __exit__(self, *raised: object) -> None:
        """Leave the cluster; immediately after an interruption."""
        if any(isinstance(each, KeyboardInterrupt) for each in raised):
            self._close_timeout = INTERRUPT_TIMEOUT
            if self._local is not None:
                self._local.kill()
        self.close()

    def _leave_scheduler(self) -> None:
        # It may be gone already.
        with suppress(OSError, RuntimeError, CancelledError, TimeoutError):
            self._client.close(timeout=self._close_timeout)

    def _connect(self, distributed: Any, name: str, workers: int) -> Any:
        target = self.address
        if workers:
            try:
                self._local = local = LocalCluster(distributed, workers)
            except (OSError, TimeoutError, RuntimeError) as error:
                raise InputError(f"{name} could not be started: {one_line(error)}.") from error
            self._opened.callback(lambda: local.close(self._close_timeout))
            target = local.address
        elif (kind := _server_kind(distributed, self.address)) != "Scheduler":
            raise InputError(f"{name} is the address of a {kind.lower()}, not of the scheduler.")
        try:
            self._client = distributed.Client(
                target, timeout=CONNECT_TIMEOUT, set_as_default=False, name="flexor"
            )
            self._opened.callback(self._leave_scheduler)
            return self._client
        except (OSError, TimeoutError, ValueError, RuntimeError) as error:
            raise InputError(f"{name} cannot be used: {one_line(error)}.") from error

    def _wait_for_workers(self) -> None:
        began = time.monotonic()
        while not self._count():
            if time.monotonic() - began > self._patience:
                raise InputError(f"{self._name} has no workers: none came in {self._patience:g} s.")
            time.sleep(0.2)
            self._counted = -_COUNT_TTL

    def _check_workers(self) -> None:
        """Refuse workers of another version before their first task."""
        run = self._client.run
        found = self._guarded(lambda: run(task.check, decisive_versions(), on_error="return"))
        for worker, why in found.items():
            # A worker that dies meanwhile is not an error.
            if why and not isinstance(why, OSError):
                if not isinstance(why, str):
                    why = f"has another Flexor, or none: {one_line(why)}"
                raise InputError(f"the worker {worker} of {self._name} {why}.")

    def _count(self) -> int:
        """Count the threads of all workers; 0 while there are none."""
        if time.monotonic() - self._counted >= _COUNT_TTL:
            if self._client.status != "running":  # it then has no scheduler to ask
                raise ClusterError(f"{self._name} was lost: {_NO_ANSWER}.")
            self._threads = sum(self._guarded(self._client.nthreads).values())
            self._counted = time.monotonic()
        return self._threads

    def _check_alive(self) -> None:
        if self._count():
            self._without_workers_since = None
        elif self._without_workers_since is None:
            self._without_workers_since = time.monotonic()
        elif time.monotonic() - self._without_workers_since > self._patience:
            raise ClusterError(
                f"{self._name} has lost all its workers: none came back in {self._patience:g} s."
            )

    def _why(self, error: BaseException) -> str:
        if type(error).__name__ == "KilledWorker":
            return "several workers died on the same designs, often out of memory; see their logs"
        if self._client.status == "running":
            return one_line(error)
        return _NO_ANSWER


def _library() -> Any:
    try:
        import distributed
    except ImportError:
        raise InputError(
            "a cluster needs the package dask[distributed], which is not installed: "
            f"{install_command('dask[distributed]')}."
        ) from None
    return distributed


def _server_kind(distributed: Any, address: str) -> str:
    """Ask what answers at an address, with a timeout, which a client does not have."""
    import asyncio  # deferred, as it is not needed without a cluster

    async def ask() -> str:
        options = distributed.Security().get_connection_args("client")
        comm = await distributed.core.connect(address, timeout=CONNECT_TIMEOUT, **options)
        try:
            await comm.write({"op": "identity"})
            return str((await comm.read())["type"])
        finally:
            comm.abort()

    async def ask_in_time() -> str:
        return await asyncio.wait_for(ask(), CONNECT_TIMEOUT)

    try:
        # In another thread: this one may have an event loop already, as in notebooks.
        with ThreadPoolExecutor(1) as pool:
            return pool.submit(asyncio.run, ask_in_time()).result()
    except Exception as error:
        late = isinstance(error, (OSError, asyncio.TimeoutError))
        why = (
            f"no Dask scheduler answers there within {CONNECT_TIMEOUT:g} s"
            if late
            else one_line(error)
        )
        raise InputError(f'the cluster "{address}" cannot be reached: {why}.') from error
