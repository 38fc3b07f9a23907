"""Overhead of a cluster: batches of 256 designs on two workers and on two threads of one process.

A scheduler and two workers on this machine, with one thread each, evaluate random designs of L+R01
on the paper's finger (0 to 5 N in 1 N steps), many batches at once, as in landscapes and population
methods. Threads and cluster are interleaved, so that other load affects their wall times equally,
and their processor times hardly; each number is a median. The processor time of the cluster is that
of scheduler, client and both workers, so that the difference is the cost of communication. Numbers
of bytes are those of the pickled messages.
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
from flexor.study import Cluster, DesignEvaluator, Problem, Threads
from flexor.study.executors.task import PickledProblem, dumps, evaluate

WORKERS = 2


@dataclass
class Times:
    """Times of one executor, run by run [s]."""

    wall: list[float]
    processor: list[float]


def main() -> None:
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--batches", type=int, default=16, help="number of batches of 256 designs in each run"
    )
    parser.add_argument("--runs", type=int, default=5, help="number of runs; medians are reported")
    options = parser.parse_args()
    model = flexor.load("finger", "calibrated")
    chosen = parameter_set("L+R01", model.design)
    problem = Problem(model, chosen, objective("bending"))
    random = np.random.default_rng(1)
    span = chosen.upper - chosen.lower
    designs = chosen.lower + span * random.random((options.batches * SIZE, chosen.size))
    taken = {"threads": Times([], []), "cluster": Times([], [])}
    with Cluster(f"local:{WORKERS}") as cluster, Progress(console=Console(stderr=True)) as progress:
        executors: dict[str, DesignEvaluator] = {"threads": Threads(WORKERS), "cluster": cluster}
        expected = problem.evaluate(designs)  # a warm-up, like the next line
        cluster.evaluate(problem, designs)
        for _ in progress.track(range(options.runs), description="batches"):
            for name, executor in executors.items():
                found, wall, processor = timed(partial(executor.evaluate, problem, designs))
                assert same(found, expected), "the results of the cluster differ"
                taken[name].wall.append(wall)
                taken[name].processor.append(processor)
        trips = [timed(lambda: cluster.evaluate(problem, designs[:1]))[1] for _ in range(30)]
    report(taken, options.batches, options.runs, statistics.median(trips), problem, designs[:SIZE])


def timed(work: Callable[[], Paths]) -> tuple[Paths, float, float]:
    """Return result, wall time and processor time of this process and its children [s]."""
    wall, processor = time.perf_counter(), processor_time()
    found = work()
    return found, time.perf_counter() - wall, processor_time() - processor


def processor_time() -> float:
    """Return the processor time of this process and its children [s]."""
    here = psutil.Process(os.getpid())
    times = [each.cpu_times() for each in (here, *here.children(recursive=True))]
    return float(sum(each.user + each.system for each in times))


def same(one: Paths, other: Paths) -> bool:
    """Return whether two results are bit-identical."""
    return all(
        getattr(one, name).tobytes() == getattr(other, name).tobytes()
        for name in ("value", "joint_angles", "tip_force", "touching", "total_iterations")
    )


def report(
    taken: dict[str, Times],
    batches: int,
    runs: int,
    trip: float,
    problem: Problem,
    batch: np.ndarray,
) -> None:
    """Print the tables."""
    console, count = Console(), batches * SIZE
    table = Table("where", "designs/s", "processor time, ms per design", "wall", "processor")
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
    console.print("wall and processor: multiples of those of the threads; results bit-identical")
    extra = [
        (a - b) / batches
        for a, b in zip(taken["cluster"].processor, taken["threads"].processor, strict=True)
    ]
    sent = len(dumps((evaluate, (batch, False))))
    back = len(pickle.dumps(problem.evaluate(batch), protocol=5))
    console.print(
        f"additional processor time per batch: {1e3 * statistics.median(extra):.1f} ms; "
        f"round trip of one design: {1e3 * trip:.1f} ms\n"
        f"problem, sent with each task: {len(PickledProblem.of(problem).content):,} bytes; "
        f"per design: {sent / SIZE:.0f} bytes sent, {back / SIZE:.0f} received",
        markup=False,
    )


if __name__ == "__main__":
    main()
