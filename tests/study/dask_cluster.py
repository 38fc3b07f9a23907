"""A real Dask cluster on the loopback: a scheduler and workers, each a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path

# As `dask scheduler` and `dask worker` do, without needing them on the PATH.
_SCHEDULER = ("-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0")
_WORKER = ("-m", "distributed.cli.dask_worker", "--nthreads", "1", "--no-nanny")
_QUIET = ("--no-dashboard",)


class DaskCluster:
    """A scheduler and workers, any of which may be killed."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._file = folder / "scheduler.json"
        self.scheduler: subprocess.Popen[bytes] | None = None
        self.workers: list[subprocess.Popen[bytes]] = []

    @property
    def address(self) -> str:
        """Of the scheduler."""
        return str(json.loads(self._file.read_text())["address"])

    def complete(self, workers: int) -> None:
        """Start two workers with their scheduler, or so many of them as are missing since."""
        if self.scheduler is None or self.scheduler.poll() is not None:
            self.stop()
            file = ("--scheduler-file", str(self._file))
            self.scheduler = self._started(*_SCHEDULER, *_QUIET, *file)
            self._wait_for_file()
            workers = 2
        self.workers = [each for each in self.workers if each.poll() is None]
        while len(self.workers) < workers:
            self.workers.append(self._started(*_WORKER, *_QUIET, self.address))

    def stop(self) -> None:
        """Kill everything."""
        for each in (*self.workers, self.scheduler):
            if each is not None:
                each.kill()
                each.wait()
        self.scheduler, self.workers = None, []
        self._file.unlink(missing_ok=True)

    def _started(self, *arguments: str) -> subprocess.Popen[bytes]:
        nothing = subprocess.DEVNULL
        return subprocess.Popen(
            [sys.executable, *arguments], cwd=self._folder, stdout=nothing, stderr=nothing
        )

    def _wait_for_file(self) -> None:
        assert self.scheduler is not None
        while not self._file.exists():
            assert self.scheduler.poll() is None, "the scheduler did not start"
            time.sleep(0.05)
