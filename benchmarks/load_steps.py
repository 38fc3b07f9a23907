"""Whether the load step matters: random designs taken to 5 N in 1 N and in 0.1 N steps.

States (joint angles, bending as L kappa, strains) are compared at every force of the coarse path
that lies before the first event of either path, all of them where there is none; the exit code is 1
if they differ by more than 1e-8 anywhere. Events say where a branch ended; designs with events are
counted, and how many of them end alike all the same.
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
    """Evaluate, and print the table."""
    reading = argparse.ArgumentParser(description=__doc__)
    reading.add_argument("--designs", type=int, default=1_000, help="of each set of constants")
    reading.add_argument(
        "--seeds", type=int, nargs="+", default=[3], help="of so many designs each"
    )
    asked = reading.parse_args()
    section, good = measure(asked.designs, tuple(asked.seeds))
    section.report()
    return 0 if good else 1


def measure(designs: int, seeds: tuple[int, ...] = (3,)) -> tuple[Section, bool]:
    """Evaluate so many random designs from each seed, and write it up; say whether all is well."""
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
            "without an event": f"{(~events).sum():,}",
            "of them ending alike to 1e-8 rad": f"{(same & ~events).sum():,}",
            "with an event": f"{events.sum():,}",
            "of them ending alike all the same": f"{(same & events).sum():,}",
            "steps compared, before any event": f"{compared:,}",
            "largest difference there / rad": f"{max(apart):.1e}",
            "designs that differ there": f"{sum(gap > BAR for gap in apart):,}",
        }
        for name, value in facts.items():
            rows.setdefault(name, []).append(value)
    made = table("", *columns)
    for name, values in rows.items():
        made.add_row(name, *values)
    command = f"./dev bench load_steps --designs {designs} --seeds {' '.join(map(str, seeds))}"
    section = Section("Independence of the load step", command)
    section.parts += [
        "Random designs taken to 5 N in 1 N and in 0.1 N steps, compared at every force of the "
        "coarse path before the first event of either:",
        made,
    ]
    return section, good


def first_event(batch: Paths) -> NDArray[np.float64]:
    """Return the force of each design's first event, (n,) [N]; infinite without one."""
    return np.array([table["force"].min(initial=np.inf) for table in batch.event_table])


if __name__ == "__main__":
    sys.exit(main())
