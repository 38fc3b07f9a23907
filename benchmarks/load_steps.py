"""Dependence on the load step: random designs loaded to 5 N in 1 N and in 0.1 N steps.

States (joint angles, bending as L kappa, strains) are compared at every force of the coarse path
before the first event of either path. The exit code is 1 if they differ by more than 1e-8 anywhere.
The report also counts the designs with events, where a branch ends, and those among them that reach
the same final state.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np
from _random_designs import geometry, random_vectors
from _section import Section, table
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track

import flexor
from flexor.model import Paths

PART = 50
BAR = 1e-8  # rad


def main() -> int:
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--designs", type=int, default=1_000, help="number per set of constants and seed"
    )
    parser.add_argument("--seeds", type=int, nargs="+", default=[3], help="random seeds")
    options = parser.parse_args()
    section, good = measure(options.designs, tuple(options.seeds))
    section.report()
    return 0 if good else 1


def measure(designs: int, seeds: tuple[int, ...] = (3,)) -> tuple[Section, bool]:
    """Evaluate random designs from each seed; return the report and whether the states agree."""
    columns = ("calibrated", "printed")
    rows: dict[str, list[str]] = {}
    good = True
    total = designs * len(seeds)
    for constants in columns:
        model = flexor.load("finger", constants)
        vectors = np.concatenate([random_vectors(model, designs, seed) for seed in seeds])
        apart, ends, eventful, compared = [], [], [], 0
        parts = range(0, total, PART)
        for first in track(parts, f"{constants} constants", console=Console(stderr=True)):
            chosen = vectors[first : first + PART]
            coarse = model.evaluate(geometry(model, chosen), "0:5:1")
            fine = model.evaluate(geometry(model, chosen), "0:5:0.1")
            before = coarse.force < np.minimum(first_event(coarse), first_event(fine))[:, None]
            gap = np.abs(coarse.q - fine.q[:, ::10])
            gap = np.where(coarse.converged & fine.converged[:, ::10], gap.max(axis=2), np.inf)
            apart += np.where(before, gap, 0.0).max(axis=1).tolist()
            ends += gap[:, -1].tolist()
            eventful += (~before.all(axis=1)).tolist()
            compared += int(before.sum())
        events, same = np.array(eventful), np.array(ends) <= BAR
        good &= max(apart) <= BAR
        facts = {
            "designs": f"{total:,}",
            "without events": f"{(~events).sum():,}",
            "with equal final states (1e-8 rad)": f"{(same & ~events).sum():,}",
            "with events": f"{events.sum():,}",
            "with equal final states nevertheless": f"{(same & events).sum():,}",
            "steps compared before any event": f"{compared:,}",
            "largest difference / rad": f"{max(apart):.1e}",
            "designs that differ": f"{sum(gap > BAR for gap in apart):,}",
        }
        for name, value in facts.items():
            rows.setdefault(name, []).append(value)
    made = table("", *columns)
    for name, values in rows.items():
        made.add_row(name, *values)
    command = f"./dev bench load_steps --designs {designs} --seeds {' '.join(map(str, seeds))}"
    section = Section("Independence of the load step", command)
    section.parts += [
        "Random designs loaded to 5 N in 1 N and in 0.1 N steps, compared at every force of the "
        "coarse path before the first event of either path:",
        made,
    ]
    return section, good


def first_event(batch: Paths) -> NDArray[np.float64]:
    """Return the force of each design's first event, (n,) [N]; infinite without one."""
    return np.array([table["force"].min(initial=np.inf) for table in batch.event_table])


if __name__ == "__main__":
    sys.exit(main())
