"""The connection to a Dask cluster, and every way in which it can fail, in sentences."""

from __future__ import annotations

import asyncio
import logging
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import CancelledError, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from flexor.errors import ClusterError, InputError
from flexor.installing import install_command
from flexor.study.executors.address import Address

# How long a scheduler may take to answer [s], and how long a cluster may be without workers.
ANSWER = 10.0
PATIENCE = 60.0
# How often a wait looks whether there is still something to wait for [s].
_LOOK = 1.0
# How long the number of threads is believed [s].
_BELIEVED = 5.0
# What Dask's processes do besides, for displays that nobody looks at: some percent of a core each.
_CALM = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
}


class Connection:
    """A client of a scheduler, which may be one that it started itself.

    Parameters
    ----------
    address : str
        As `Address.read` takes it.
    patience : float
        How long the cluster may be without workers [s].

    Raises
    ------
    InputError
        If the library is missing, the address is none, nobody answers there, there are no
        workers, or one of them runs another version of Flexor.
    """

    def __init__(self, address: str, patience: float = PATIENCE) -> None:
        self.address = Address.read(address)
        self._patience = patience
        self._cluster: Any = None
        self._client: Any = None
        self._threads, self._counted = 0, -_BELIEVED
        distributed = _library()
        # Its client logs how connections break, which is said in sentences here.
        self._log = logging.getLogger("distributed.client")
        self._log_level = self._log.level
        self._log.setLevel(logging.CRITICAL + 1)
        try:
            self._open(distributed)
            self._wait_for_workers()
            self._check_versions()
        except BaseException:
            self.close()
            raise

    @property
    def threads(self) -> int:
        """Threads of all workers together; 0 while there are none."""
        if time.monotonic() - self._counted >= _BELIEVED:
            self._threads = sum(self._guarded(self._client.nthreads).values())
            self._counted = time.monotonic()
        return self._threads

    def on_every_worker(self, function: Callable[..., Any], *arguments: Any) -> Mapping[str, Any]:
        """Call a function on every worker at once; results, or exceptions, by address."""
        found: Mapping[str, Any] = self._guarded(
            self._client.run, function, *arguments, on_error="return"
        )
        return found

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Have a function called on some worker; return what `result` waits for."""
        return self._guarded(self._client.submit, function, *arguments, pure=False)

    def result(self, future: Any, stopped: Callable[[], bool] | None = None) -> Any:
        """Wait for the result of a call.

        Parameters
        ----------
        future
            What `submit` returned.
        stopped : callable, optional
            Asked now and then whether nobody waits any more.

        Raises
        ------
        CancelledError
            If nobody does.
        ClusterError
            If the cluster is lost, or has been without workers for too long.
        Exception
            What the function raised.
        """
        done = threading.Event()
        future.add_done_callback(lambda _: done.set())
        bare_since: float | None = None
        while True:
            if done.wait(_LOOK) or future.done():
                # Without a timeout: with one, Dask may lose the result that comes just then.
                return self._guarded(future.result)
            if stopped is not None and stopped():
                raise CancelledError
            if self.threads:
                bare_since = None
            elif bare_since is None:
                bare_since = time.monotonic()
            elif time.monotonic() - bare_since > self._patience:
                raise ClusterError(
                    f'the cluster "{self.address.text}" has lost all its workers: none came back '
                    f"in {self._patience:g} s."
                )

    def close(self) -> None:
        """Leave the cluster; stop it, if it was started here."""
        for each in (self._client, self._cluster):
            if each is not None:
                with suppress(OSError, RuntimeError, CancelledError):  # it may be gone already
                    each.close(timeout=ANSWER)
        self._client = self._cluster = None
        self._log.setLevel(self._log_level)

    def _open(self, distributed: Any) -> None:
        text, target = self.address.text, self.address.text
        if self.address.local:
            try:
                self._cluster = _started(distributed, self.address.local)
            except (OSError, TimeoutError, RuntimeError) as error:
                raise InputError(
                    f'the cluster "{text}" could not be started: {_one_line(error)}.'
                ) from error
            target = self._cluster.scheduler_address
        elif (kind := _asked_what_it_is(distributed, self.address.text)) != "Scheduler":
            raise InputError(
                f'the cluster "{text}" is the address of a {kind.lower()}, not of the scheduler.'
            )
        try:
            self._client = distributed.Client(
                target, timeout=ANSWER, set_as_default=False, name="flexor"
            )
        except (OSError, TimeoutError, ValueError, RuntimeError) as error:
            raise InputError(f'the cluster "{text}" cannot be used: {_one_line(error)}.') from error

    def _wait_for_workers(self) -> None:
        began = time.monotonic()
        while not self.threads:
            if time.monotonic() - began > self._patience:
                raise InputError(
                    f'the cluster "{self.address.text}" has no workers: none came in '
                    f"{self._patience:g} s."
                )
            time.sleep(0.2)
            self._counted = -_BELIEVED

    def _check_versions(self) -> None:
        """Refuse workers of another version; asked in a way that works without Flexor there."""
        here = version("flexor")
        for worker, found in self.on_every_worker(version, "flexor").items():
            if isinstance(found, PackageNotFoundError):
                raise InputError(
                    f'the worker {worker} of the cluster "{self.address.text}" has no Flexor: '
                    f"install version {here} there."
                )
            if isinstance(found, str) and found != here:
                raise InputError(
                    f'the worker {worker} of the cluster "{self.address.text}" runs Flexor '
                    f"{found}, this is {here}: install the same version."
                )

    def _guarded(self, call: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
        """Call something of the client; if the scheduler is lost, say so."""
        try:
            return call(*arguments, **options)
        except (OSError, RuntimeError, ValueError, CancelledError, asyncio.TimeoutError) as error:
            here = self._client is not None and self._client.status == "running"
            if here and isinstance(error, (RuntimeError, ValueError)):
                raise
            raise ClusterError(
                f'the cluster "{self.address.text}" was lost: its scheduler no longer answers.'
            ) from error


def _library() -> Any:
    try:
        import distributed
    except ImportError:
        raise InputError(
            "a cluster needs the package dask[distributed], which is not installed: "
            f"{install_command('dask[distributed]')}."
        ) from None
    return distributed


def _asked_what_it_is(distributed: Any, address: str) -> str:
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
            f'the cluster "{address}" cannot be reached: {_one_line(error)}.'
        ) from error


def _started(distributed: Any, workers: int) -> Any:
    """Start a cluster on this machine, whose processes do not watch themselves all the time."""
    import dask

    with dask.config.set(_CALM), _uninterrupted():
        return distributed.LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            dashboard_address="127.0.0.1:0",  # whatever is free, seen from here only
            worker_dashboard_address=None,
            memory_limit=0,
            silence_logs=logging.CRITICAL,
        )


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Start processes that do not hear Ctrl-C: it is for this one, which then stops them."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _one_line(error: BaseException) -> str:
    return " ".join(str(error).split()).rstrip(".") or type(error).__name__
