"""A Dask cluster by its address: connected to or started, and in sentences where that fails."""

from __future__ import annotations

import asyncio
import logging
import signal
import time
from collections.abc import Iterator
from concurrent.futures import CancelledError, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing import active_children
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Any

from flexor.errors import ClusterError, InputError
from flexor.installing import install_command
from flexor.store.environment import decisive
from flexor.study.executors import task
from flexor.study.executors.address import Address
from flexor.study.executors.pool import Pool
from flexor.study.executors.task import one_line

# How long a scheduler may take to answer [s], and how long a cluster may be without workers.
ANSWER = 10.0
AT_ONCE = 0.3
PATIENCE = 60.0
# How long the number of threads is believed [s].
_BELIEVED = 5.0
# Displays that nobody looks at cost Dask's processes some percent of a core each.
_WITHOUT_DISPLAYS = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
}


class Cluster(Pool):
    """Evaluates on the workers of a Dask cluster.

    What a worker that dies was doing is done again by another.

    Parameters
    ----------
    address : str
        Of the scheduler, such as ``"tcp://HOST:8786"``; ``"local:4"`` starts four workers on this
        machine, which end with the executor.
    patience : float
        How long the cluster may be without any worker [s], at first and later.

    Raises
    ------
    InputError
        If Dask is not installed, the address is none, nobody answers there, there are no workers,
        or one of them runs another version of Flexor or another build of its engine.

    Notes
    -----
    `parts` raises `flexor.errors.ClusterError` if the cluster is lost; what was evaluated until
    then is in the record of the study. Processes of ``local:N`` import the main module of a
    script, so that a script needs ``if __name__ == "__main__":``.
    """

    def __init__(self, address: str, patience: float = PATIENCE) -> None:
        where = Address.read(address)
        self.address = where.text
        self._patience = patience
        self._cluster: Any = None
        self._loop: Any = None
        self._others = set(active_children())
        self._scratch: TemporaryDirectory[str] | None = None
        self._client: Any = None
        self._threads, self._counted = 0, -_BELIEVED
        self._bare_since: float | None = None
        distributed = _library()
        # Its client logs how connections break, which is said in sentences here.
        self._log = logging.getLogger("distributed.client")
        self._log_level = self._log.level
        self._log.setLevel(logging.CRITICAL + 1)
        try:
            client = self._connect(distributed, where)
            super().__init__(client.get_executor(), f'the cluster "{self.address}"')
            self._wait_for_workers()
            self._check_workers()
        except BaseException as error:
            self._leave(isinstance(error, KeyboardInterrupt))
            raise

    @property
    def slots(self) -> int:
        """Threads of all workers together."""
        return max(self._count(), 1)

    def close(self) -> None:
        """Leave the cluster; stop it, if it was started here."""
        self._leave(at_once=False)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._leave(at_once=isinstance(error, KeyboardInterrupt))

    def _leave(self, at_once: bool) -> None:
        if at_once and self._cluster is not None:
            # Workers would finish what they are doing, and others take their places.
            self._cluster.shutdown_on_close = False
            for nanny in self._cluster.workers.values():
                nanny.auto_restart = False
            for process in set(active_children()) - self._others:
                process.kill()
        for each in (self._client, self._cluster):
            if each is not None:
                # It may be gone already.
                with suppress(OSError, RuntimeError, CancelledError, TimeoutError):
                    each.close(timeout=AT_ONCE if at_once else ANSWER)
        if self._loop is not None:
            self._loop.stop(timeout=AT_ONCE if at_once else ANSWER)
        self._client = self._cluster = self._loop = None
        if self._scratch is not None:
            self._scratch.cleanup()
            self._scratch = None
        self._log.setLevel(self._log_level)

    def _connect(self, distributed: Any, where: Address) -> Any:
        target = self.address
        if where.local:
            try:
                self._scratch = TemporaryDirectory(prefix="flexor-", ignore_cleanup_errors=True)
                self._start(distributed, where.local, self._scratch.name)
            except (OSError, TimeoutError, RuntimeError) as error:
                raise InputError(
                    f'the cluster "{self.address}" could not be started: {one_line(error)}.'
                ) from error
            target = self._cluster.scheduler_address
        elif (kind := _kind_of_server(distributed, self.address)) != "Scheduler":
            raise InputError(
                f'the cluster "{self.address}" is the address of a {kind.lower()}, not of the '
                "scheduler."
            )
        try:
            self._client = distributed.Client(
                target, timeout=ANSWER, set_as_default=False, name="flexor"
            )
            return self._client
        except (OSError, TimeoutError, ValueError, RuntimeError) as error:
            raise InputError(
                f'the cluster "{self.address}" cannot be used: {one_line(error)}.'
            ) from error

    def _start(self, distributed: Any, workers: int, scratch: str) -> None:
        """Start a cluster on this machine."""
        import dask

        self._loop = distributed.utils.LoopRunner()
        with _interrupts_blocked():
            self._loop.start()
        settings = {**_WITHOUT_DISPLAYS, "temporary-directory": scratch}
        with dask.config.set(settings):
            # Known before it has started, so that it can be stopped then.
            self._cluster = distributed.LocalCluster.__new__(distributed.LocalCluster)
            self._cluster.__init__(
                n_workers=workers,
                threads_per_worker=1,
                local_directory=scratch,
                dashboard_address="127.0.0.1:0",  # whatever is free, seen from here only
                worker_dashboard_address=None,
                memory_limit=0,
                silence_logs=logging.CRITICAL,
                loop=self._loop.loop,
            )

    def _wait_for_workers(self) -> None:
        began = time.monotonic()
        while not self._count():
            if time.monotonic() - began > self._patience:
                raise InputError(f"{self._name} has no workers: none came in {self._patience:g} s.")
            time.sleep(0.2)
            self._counted = -_BELIEVED

    def _check_workers(self) -> None:
        """Refuse workers of another version at once, and not at their first task."""
        run = self._client.run
        found = self._guarded(lambda: run(task.check, decisive(), on_error="return"))
        for worker, why in found.items():
            # A worker that dies meanwhile is nobody's fault.
            if why and not isinstance(why, OSError):
                if not isinstance(why, str):
                    why = f"has another Flexor, or none: {one_line(why)}"
                raise InputError(f"the worker {worker} of {self._name} {why}.")

    def _count(self) -> int:
        """Count the threads of all workers; 0 while there are none."""
        if time.monotonic() - self._counted >= _BELIEVED:
            self._threads = sum(self._guarded(self._client.nthreads).values())
            self._counted = time.monotonic()
        return self._threads

    def _check_alive(self) -> None:
        if self._count():
            self._bare_since = None
        elif self._bare_since is None:
            self._bare_since = time.monotonic()
        elif time.monotonic() - self._bare_since > self._patience:
            raise ClusterError(
                f"{self._name} has lost all its workers: none came back in {self._patience:g} s."
            )

    def _why(self, error: BaseException) -> str:
        if type(error).__name__ == "KilledWorker":
            return (
                "it lost one worker after another at the same designs, and their logs say why, "
                "often for want of memory"
            )
        if self._client is not None and self._client.status == "running":
            return one_line(error)
        return "its scheduler no longer answers"


def _library() -> Any:
    try:
        import distributed
    except ImportError:
        raise InputError(
            "a cluster needs the package dask[distributed], which is not installed: "
            f"{install_command('dask[distributed]')}."
        ) from None
    return distributed


def _kind_of_server(distributed: Any, address: str) -> str:
    """Ask what answers at an address, once and not for ever, as a client would not do.

    Raises
    ------
    InputError
        If nothing does that speaks as Dask does.
    """

    async def ask() -> str:
        options = distributed.Security().get_connection_args("client")
        comm = await distributed.core.connect(address, timeout=ANSWER, **options)
        try:
            await comm.write({"op": "identity"})
            return str((await comm.read())["type"])
        finally:
            comm.abort()

    async def ask_in_time() -> str:
        return await asyncio.wait_for(ask(), ANSWER)

    try:
        # In a thread of its own: this one may have a loop already, as in notebooks.
        with ThreadPoolExecutor(1) as pool:
            return pool.submit(asyncio.run, ask_in_time()).result()
    except (OSError, asyncio.TimeoutError) as error:
        why = f"no Dask scheduler answers there within {ANSWER:g} s"
        raise InputError(f'the cluster "{address}" cannot be reached: {why}.') from error
    except Exception as error:
        raise InputError(
            f'the cluster "{address}" cannot be reached: {one_line(error)}.'
        ) from error


@contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Start a thread whose processes do not hear Ctrl-C: it is for this one, which stops them."""
    if not hasattr(signal, "pthread_sigmask"):  # on Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
