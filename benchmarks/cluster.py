"""What a cluster costs: batches of 256 designs on two workers, against two threads of one process.

A real scheduler and two workers on this machine, one thread each, evaluate random designs of L+R01
on the paper's finger (0 to 5 N in 1 N steps), many batches at once as landscapes and generations
give them; threads and cluster take turns, and each number is a median. Wall times of two ways that
take turns are disturbed alike by whatever else runs; their processor times hardly. The processor
time of the cluster is that of scheduler, client and both workers, so that the difference is what
sending designs and outcomes to and fro costs. Bytes are those of the pickled messages.
"""

from __future__ import annotations

import argparse
import os
import pickle
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import psutil
from _machine import machine
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

import flexor
from flexor.design import parameter_set
from flexor.model import Paths
from flexor.model.chunks import SIZE
from flexor.objectives import objective
from flexor.study import Cluster, Executor, Problem, Threads
from flexor.study.executors.task import PickledProblem, dumps, evaluate

WORKERS = 2


@dataclass
class Taken:
    """What one way took, run by run."""

    wall: list[float]
    processor: list[float]


def main() -> None:
    """Measure, and print the table."""
    reading = argparse.ArgumentParser(description=__doc__)
    reading.add_argument("--batches", type=int, default=16, help="of 256 designs, in each run")
    reading.add_argument("--runs", type=int, default=5, help="of which the median is printed")
    asked = reading.parse_args()
    model = flexor.load("finger", "calibrated")
    chosen = parameter_set("L+R01", model.design)
    problem = Problem(model, chosen, objective("bending"))
    random = np.random.default_rng(1)
    span = chosen.upper - chosen.lower
    designs = chosen.lower + span * random.random((asked.batches * SIZE, chosen.size))
    taken = {"threads": Taken([], []), "cluster": Taken([], [])}
    with Cluster(f"local:{WORKERS}") as cluster, Progress(console=Console(stderr=True)) as progress:
        ways: dict[str, Executor] = {"threads": Threads(WORKERS), "cluster": cluster}
        expected = problem.evaluate(designs)  # warms caches, as the next does
        cluster.evaluate(problem, designs)
        for _ in progress.track(range(asked.runs), description="batches"):
            for name, executor in ways.items():
                found, wall, processor = timed(partial(executor.evaluate, problem, designs))
                assert same(found, expected), "the cluster's outcomes differ"
                taken[name].wall.append(wall)
                taken[name].processor.append(processor)
        trips = [timed(lambda: cluster.evaluate(problem, designs[:1]))[1] for _ in range(30)]
    report(taken, asked.batches, asked.runs, statistics.median(trips), problem, designs[:SIZE])


def timed(work: Callable[[], Paths]) -> tuple[Paths, float, float]:
    """Return what came out, wall time and processor time of this process and its children [s]."""
    wall, processor = time.perf_counter(), processor_time()
    found = work()
    return found, time.perf_counter() - wall, processor_time() - processor


def processor_time() -> float:
    """Return the processor time of this process and of those it started [s]."""
    here = psutil.Process(os.getpid())
    times = [each.cpu_times() for each in (here, *here.children(recursive=True))]
    return float(sum(each.user + each.system for each in times))


def same(one: Paths, other: Paths) -> bool:
    """Say whether two outcomes agree to the last bit."""
    return all(
        getattr(one, name).tobytes() == getattr(other, name).tobytes()
        for name in ("value", "joint_angles", "tip_force", "touching", "total_iterations")
    )


def report(
    taken: dict[str, Taken],
    batches: int,
    runs: int,
    trip: float,
    problem: Problem,
    batch: np.ndarray,
) -> None:
    """Print the tables."""
    console, count = Console(), batches * SIZE
    table = Table("where", "designs/s", "processor time, ms a design", "wall", "processor")
    for column in table.columns[1:]:
        column.justify = "right"
    for name, each in taken.items():
        walls = zip(each.wall, taken["threads"].wall, strict=True)
        processors = zip(each.processor, taken["threads"].processor, strict=True)
        table.add_row(
            {"threads": f"{WORKERS} threads", "cluster": f"cluster, {WORKERS} workers"}[name],
            f"{count / statistics.median(each.wall):,.0f}",
            f"{1e3 * statistics.median(each.processor) / count:.3f}",
            f"{statistics.median(a / b for a, b in walls):.2f}",
            f"{statistics.median(a / b for a, b in processors):.2f}",
        )
    load = f"load of the machine {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""
    console.print(
        f"{machine()}; {batches} batches of {SIZE} designs, medians of {runs} runs; {load}",
        markup=False,
    )
    console.print(table)
    console.print("wall and processor: as multiples of the threads'; outcomes the same to the bit")
    extra = [
        (a - b) / batches
        for a, b in zip(taken["cluster"].processor, taken["threads"].processor, strict=True)
    ]
    sent = len(dumps((evaluate, (batch, False))))
    back = len(pickle.dumps(problem.evaluate(batch), protocol=5))
    console.print(
        f"a batch costs {1e3 * statistics.median(extra):.1f} ms of processor time more; "
        f"one design there and back takes {1e3 * trip:.1f} ms\n"
        f"the problem, with each task: {len(PickledProblem.of(problem).content):,} bytes; "
        f"a design: {sent / SIZE:.0f} bytes there, {back / SIZE:.0f} back",
        markup=False,
    )


if __name__ == "__main__":
    main()
