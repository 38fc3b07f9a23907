"""Solver status of 10,000 random designs with both sets of constants.

Designs are sampled within the search bounds of L+R01 and loaded from 0 to 5 N in 1 N steps. A
design counts by its worst status; the exit code is 1 if a result of a converged step is not finite,
or if fewer than 99.9 % of the designs converge to stable equilibria at every step.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter

import numpy as np
from _machine import machine
from _random_designs import geometry, random_vectors
from rich.console import Console
from rich.progress import track
from rich.table import Table

import flexor
from flexor._engine import STATUS
from flexor.model import Batch

PART = 100
GOOD = "converged and stable at every step"


def main() -> int:
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--designs", type=int, default=10_000, help="number of designs per set of constants"
    )
    arguments = parser.parse_args()
    table = Table("constants", "status", "designs", "share")
    for column in table.columns[2:]:
        column.justify = "right"
    good = True
    for constants in ("calibrated", "printed"):
        model = flexor.load("finger", constants)
        vectors = random_vectors(model, arguments.designs, seed=2)
        ends: Counter[str] = Counter()
        events = iterations = snapping = broken = 0
        parts = range(0, arguments.designs, PART)
        for first in track(parts, f"{constants} constants", console=Console(stderr=True)):
            batch = model.evaluate(geometry(model, vectors[first : first + PART]))
            ends.update(worst(batch))
            events += len(batch.events["design"])
            snapping += len(set(batch.events["design"].tolist()))
            iterations += int(batch.iterations.sum())
            broken += not_finite(batch)
        good &= ends[GOOD] >= 0.999 * arguments.designs and broken == 0
        for status, count in ends.most_common():
            table.add_row(constants, status, f"{count:,}", f"{count / arguments.designs:.2%}")
            constants = ""
        table.add_row("", "with events", f"{snapping:,}", f"{snapping / arguments.designs:.2%}")
        table.add_row("", "events per design", f"{events / arguments.designs:.2f}", "")
        table.add_row("", "iterations per design", f"{iterations / arguments.designs:.1f}", "")
        table.add_row("", "converged steps with non-finite results", f"{broken:,}", "")
        table.add_section()
    console = Console()
    console.print(machine(), markup=False)
    console.print(table)
    return 0 if good else 1


def worst(batch: Batch) -> list[str]:
    """Return the first status of each design other than converged and stable."""
    names = []
    for codes, stable in zip(batch.status.tolist(), batch.stable.tolist(), strict=True):
        bad = [STATUS[code] for code in codes if STATUS[code] != "converged"]
        names.append(bad[0] if bad else GOOD if all(stable) else "unstable")
    return names


def not_finite(batch: Batch) -> int:
    """Count the converged steps with non-finite results."""
    finite = np.isfinite(batch.q).all(axis=2)
    for numbers in (batch.energy, batch.residual, batch.tip_force):
        finite &= np.isfinite(numbers)
    return int((batch.converged & ~finite).sum())


if __name__ == "__main__":
    sys.exit(main())
