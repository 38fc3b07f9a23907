"""A Dask cluster on this machine, whose processes end with this one and ignore Ctrl-C."""

from __future__ import annotations

import logging
import signal
from collections.abc import Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from tempfile import TemporaryDirectory
from typing import Any

# Dashboards and profilers cost Dask's processes some percent of a core each.
_WITHOUT_DASHBOARDS = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
}


class LocalCluster:
    """Worker processes on this machine and their temporary folder."""

    def __init__(self, distributed: Any, workers: int) -> None:
        import dask

        self._others = _processes()
        self._scratch = TemporaryDirectory(prefix="flexor-", ignore_cleanup_errors=True)
        self._loop = distributed.utils.LoopRunner()
        # Known before it has started, so that it can be stopped while it does.
        self._cluster = distributed.LocalCluster.__new__(distributed.LocalCluster)
        place = self._scratch.name
        try:
            with _interrupts_ignored():
                self._loop.start()
            with dask.config.set({**_WITHOUT_DASHBOARDS, "temporary-directory": place}):
                self._cluster.__init__(
                    n_workers=workers,
                    threads_per_worker=1,
                    local_directory=place,
                    dashboard_address="127.0.0.1:0",  # any free port, local only
                    worker_dashboard_address=None,
                    memory_limit=0,
                    silence_logs=logging.CRITICAL,
                    loop=self._loop.loop,
                )
        except BaseException:
            self.kill()
            self.close(0.3)
            raise

    @property
    def address(self) -> str:
        """Address of the scheduler."""
        return str(self._cluster.scheduler_address)

    def kill(self) -> None:
        """Kill the workers, which would finish what they are doing, and start no others."""
        self._cluster.shutdown_on_close = False
        for nanny in getattr(self._cluster, "workers", {}).values():
            nanny.auto_restart = False
        for process in _processes() - self._others:
            process.kill()

    def close(self, timeout: float) -> None:
        """Stop everything within some seconds."""
        with suppress(OSError, RuntimeError, AttributeError, CancelledError, TimeoutError):
            self._cluster.close(timeout=timeout)
        with suppress(TimeoutError):
            self._loop.stop(timeout=timeout)
        self._scratch.cleanup()


def _processes() -> set[Any]:
    from multiprocessing import active_children  # deferred: takes a twentieth of a second

    return set(active_children())


@contextmanager
def _interrupts_ignored() -> Iterator[None]:
    """Start a thread whose processes ignore Ctrl-C: this process stops them."""
    if not hasattr(signal, "pthread_sigmask"):  # on Windows
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
