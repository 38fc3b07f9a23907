"""What many designs take: the most memory that a process uses for 100,000 of them.

Once as a batch that keeps every state (`Model.evaluate`), once as a study that keeps every
evaluation in its folder (a grid of L+R01), each in a process of its own.
"""

from __future__ import annotations

import argparse
import multiprocessing
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from _random_designs import random_designs
from _section import Section, table
from _timing import progress

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
    status = Path("/proc/self/status")
    if status.exists():  # getrusage would also count the process that began this one
        (line,) = (x for x in status.read_text().splitlines() if x.startswith("VmHWM"))
        return int(line.split()[1]) / 1e3
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
    reading.add_argument("--runs", type=int, default=3, help="of which medians are shown")
    asked = reading.parse_args()
    section = measure(asked.designs, asked.runs)
    section.report()


def measure(designs: int, runs: int) -> Section:
    """Measure everything, and write it up."""
    made = table("what", "designs", "seconds", "peak memory / MB")
    works = {"interpreter and packages": nothing, "batch": batch, "study": study}
    with progress() as bar:
        for name, work in works.items():
            found = []
            for _ in bar.track(range(runs), description=f"{name}, {designs:,} designs"):
                with multiprocessing.get_context("spawn").Pool(1) as pool:
                    found.append(pool.apply(measured, (work, designs)))
            count, seconds, most = (
                statistics.median(values) for values in zip(*found, strict=True)
            )
            made.add_row(name, f"{count:,.0f}", f"{seconds:.1f}", f"{most:.0f}")
    section = Section("Memory", f"./dev bench memory --designs {designs}")
    section.parts += [
        "The most memory that a process uses for random designs of finger and exosuit, each with "
        "six load steps: as a batch that keeps every state, and as a study that keeps every "
        f"evaluation in its folder; medians of {runs} processes.",
        made,
    ]
    return section


if __name__ == "__main__":
    main()
