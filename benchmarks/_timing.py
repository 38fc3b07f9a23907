"""Interleaved timing, so that disturbances affect everything that is compared alike."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np
from rich.console import Console
from rich.progress import Progress


@dataclass
class Times:
    """Wall and processor time of every run of one task [s]."""

    wall: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)

    def run(self, work: Callable[[], object]) -> object:
        """Run a task once and record its time; processor time is that of all threads."""
        wall, cpu = time.perf_counter(), time.process_time()
        result = work()
        self.cpu.append(time.process_time() - cpu)
        self.wall.append(time.perf_counter() - wall)
        return result

    @property
    def median(self) -> float:
        """Median processor time [s]."""
        return statistics.median(self.cpu)


def by_turns(
    works: Mapping[str, Callable[[], object]], runs: int, description: str
) -> dict[str, Times]:
    """Run every task once as a warm-up, then all of them in turn, `runs` times."""
    times = {name: Times() for name in works}
    with progress() as bar:
        for turn in bar.track(range(runs + 1), description=description):
            for name, work in works.items():
                (times[name] if turn else Times()).run(work)
    return times


def enough(work: Callable[[], object], least: float = 0.05) -> int:
    """Return the number of repetitions of a task that take at least a given time [s]."""
    first, second = Times(), Times()
    first.run(work)
    second.run(work)
    return int(np.ceil(least / max(second.median, 1e-6)))


def repeated(work: Callable[[], object], times: int) -> Callable[[], None]:
    """Return a task that repeats another one."""

    def often() -> None:
        for _ in range(times):
            work()

    return often


@contextmanager
def progress() -> Iterator[Progress]:
    """Show progress on stderr."""
    with Progress(console=Console(stderr=True)) as bar:
        yield bar


def exponent(sizes: Sequence[float], costs: Sequence[float]) -> float:
    """Fit cost = c sizeᵃ by least squares of the logarithms, and return a."""
    return float(np.polyfit(np.log(sizes), np.log(costs), 1)[0])


def local_exponents(sizes: Sequence[float], costs: Sequence[float]) -> list[float]:
    """Return the exponent between each size and the next."""
    return list(np.diff(np.log(costs)) / np.diff(np.log(sizes)))
