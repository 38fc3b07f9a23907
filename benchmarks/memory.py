"""Peak memory of a process for 100,000 designs.

As a batch with all states (`Model.evaluate`) and as a recorded study (a grid of L+R01), each in a
separate process.
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
    """Evaluate a batch; return its number of designs."""
    model = flexor.load("finger", "calibrated")
    return len(model.evaluate(random_designs(model, designs)))


def study(designs: int) -> int:
    """Record a grid of about the given number of designs; return its number of designs."""
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
    """Return designs, seconds and peak memory [MB]."""
    began = time.perf_counter()
    count = work(designs)
    return count, time.perf_counter() - began, peak()


def peak() -> float:
    """Return the peak memory of this process [MB]."""
    if sys.platform == "win32":
        return float("nan")
    status = Path("/proc/self/status")
    if status.exists():  # getrusage would include the parent's peak
        (line,) = (x for x in status.read_text().splitlines() if x.startswith("VmHWM"))
        return int(line.split()[1]) / 1e3
    import resource

    found = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return found / (1e6 if sys.platform == "darwin" else 1e3)


def nothing(designs: int) -> int:
    """Do nothing, to measure interpreter and imports."""
    return 0 * designs


def main() -> None:
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=100_000)
    parser.add_argument("--runs", type=int, default=3, help="number of runs; medians are reported")
    arguments = parser.parse_args()
    section = measure(arguments.designs, arguments.runs)
    section.report()


def measure(designs: int, runs: int) -> Section:
    """Run the benchmark and return its report."""
    result = table("what", "designs", "seconds", "peak memory / MB")
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
            result.add_row(name, f"{count:,.0f}", f"{seconds:.1f}", f"{most:.0f}")
    section = Section("Memory", f"./dev bench memory --designs {designs}")
    section.parts += [
        "Peak memory of a process for random designs of finger and exosuit with six load steps, as "
        f"a batch with all states and as a recorded study; medians of {runs} processes.",
        result,
    ]
    return section


if __name__ == "__main__":
    main()
