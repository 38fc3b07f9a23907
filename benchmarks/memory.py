"""What many designs take: the most memory that a process uses for 100,000 of them.

Once as a batch that keeps every state (`Model.evaluate`), once as a study that keeps every
evaluation in its folder (a grid of L+R01), each in a process of its own.
"""

from __future__ import annotations

import argparse
import multiprocessing
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from _machine import machine
from _random_designs import random_designs
from rich.console import Console
from rich.table import Table

import flexor


def batch(designs: int) -> int:
    """Evaluate a batch; return how many designs it has."""
    model = flexor.load("finger", "calibrated")
    return len(model.evaluate(random_designs(model, designs)))


def study(designs: int) -> int:
    """Record a grid of about so many designs; return how many it has."""
    points = round(designs ** (1.0 / 3.0))
    with tempfile.TemporaryDirectory() as folder:
        found = flexor.optimize(
            flexor.load("finger", "calibrated"),
            "L+R01",
            method="grid",
            method_options={"points": points},
            folder=Path(folder) / "study",
        )
        evaluations = found.evaluations
        found.close()
    return evaluations


def measured(work: Callable[[int], int], designs: int) -> tuple[int, float, float]:
    """Return designs, seconds and the most memory used [MB]."""
    began = time.perf_counter()
    count = work(designs)
    return count, time.perf_counter() - began, peak()


def peak() -> float:
    """Return the most memory that this process has used [MB]."""
    if sys.platform == "win32":
        return float("nan")
    import resource

    found = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return found / (1e6 if sys.platform == "darwin" else 1e3)


def nothing(designs: int) -> int:
    """Do nothing but what comes before."""
    return 0 * designs


def main() -> None:
    """Measure, and print the table."""
    reading = argparse.ArgumentParser(description=__doc__)
    reading.add_argument("--designs", type=int, default=100_000)
    asked = reading.parse_args()
    table = Table("what", "designs", "seconds", "peak memory / MB")
    for column in table.columns[1:]:
        column.justify = "right"
    works = {"interpreter and packages": nothing, "batch": batch, "study": study}
    console = Console(stderr=True)
    for name, work in works.items():
        with (
            console.status(f"{name}, {asked.designs:,} designs"),
            multiprocessing.get_context("spawn").Pool(1) as pool,
        ):
            count, seconds, most = pool.apply(measured, (work, asked.designs))
        table.add_row(name, f"{count:,}", f"{seconds:.1f}", f"{most:.0f}")
    console = Console()
    console.print(machine(), markup=False)
    console.print(table)


if __name__ == "__main__":
    main()
