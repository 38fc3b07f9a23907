"""Long searches for the best designs of the problems on which search methods are measured.

Each problem (`_design_problems.py`) is searched by methods of different kinds, from random
starts, each with as many designs as asked for. A run that ends early is begun again with another
seed until its designs are spent. The best feasible design and every run go into
`best_known.json`; runs that are in it already are not repeated, so that more can be added.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import Any

from _design_problems import NAMES, problem, record, recorded

from flexor.optimizers import Auto, CmaEs, DifferentialEvolution, PatternSearch, Search
from flexor.study import Problem
from flexor.study.optimization import run_search
from flexor.study.settings import STUDY

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from reproduction.multistage import MultistageSearch


def kinds(designs: int, size: int) -> tuple[Search, ...]:
    """Return searches of different kinds, with restarts or starts to use their designs."""
    return (
        MultistageSearch(designs),
        Auto(evaluations=designs),
        DifferentialEvolution(population=60, patience=1_000_000),
        CmaEs(restarts=50),
        PatternSearch(starts=max(designs // (60 * size), 8)),
    )


def run(wanted: Problem, number: int, designs: int) -> dict[str, Any]:
    """Search once; return what was found."""
    every = kinds(designs, wanted.parameters.size)
    search = every[number % len(every)]
    best: tuple[float, float, list[float]] | None = None
    left, seed, began = designs, 1000 * (number + 1), time.monotonic()
    while left > designs // 20:
        study = run_search(STUDY, wanted, search, "random", seed=seed, budget=left)
        found = study.best
        key = (found.violation, found.value, found.vector.tolist())
        best = key if best is None else min(best, key)
        left -= study.evaluations
        seed += 1
        study.close()
    assert best is not None
    return {
        "run": number,
        "method": search.name,
        "designs": designs - left,
        "seconds": round(time.monotonic() - began),
        "violation": best[0],
        "value": best[1],
        "design": best[2],
    }


def main() -> None:
    """Search, and write the table after every run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--problems", nargs="+", default=NAMES, choices=NAMES)
    parser.add_argument("--runs", type=int, default=20, help="runs of each problem")
    parser.add_argument("--designs", type=int, default=100_000, help="designs of each run")
    options = parser.parse_args()
    for number in range(options.runs):
        for name in options.problems:
            runs = recorded().get(name, {}).get("runs", [])
            if any(each["run"] == number for each in runs):
                continue
            wanted = problem(name)
            found = run(wanted, number, options.designs)
            record(name, found, wanted)
            print(f"{name}, run {number}: {found['method']} {found['value']:.6f}", flush=True)


if __name__ == "__main__":
    main()
