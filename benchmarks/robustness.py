"""Status of 10,000 random designs with two sets of constants.

Designs are drawn uniformly within the search bounds of L+R01 and loaded from 0 to 5 N in 1 N steps.
A design is counted by its worst status along the path. The exit code is 1 if a converged step has a
value that is not finite, or fewer than 99.9 % of the designs converged to stable states at every
step.
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
from flexor.model import Paths

PART = 100
GOOD = "converged and stable at every step"


def main() -> int:
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=10_000, help="number per set of constants")
    options = parser.parse_args()
    table = Table("constants", "status", "designs", "share")
    for column in table.columns[2:]:
        column.justify = "right"
    good = True
    for constants in ("calibrated", "printed"):
        model = flexor.load("finger", constants)
        vectors = random_vectors(model, options.designs, seed=2)
        ends: Counter[str] = Counter()
        events = iterations = snapping = broken = 0
        parts = range(0, options.designs, PART)
        for first in track(parts, f"{constants} constants", console=Console(stderr=True)):
            batch = model.evaluate(geometry(model, vectors[first : first + PART]))
            ends.update(worst(batch))
            events += int(batch.event_count.sum())
            snapping += int((batch.event_count > 0).sum())
            iterations += int(batch.iterations.sum())
            broken += not_finite(batch)
        good &= ends[GOOD] >= 0.999 * options.designs and broken == 0
        for status, count in ends.most_common():
            table.add_row(constants, status, f"{count:,}", f"{count / options.designs:.2%}")
            constants = ""
        table.add_row("", "with events", f"{snapping:,}", f"{snapping / options.designs:.2%}")
        table.add_row("", "events per design", f"{events / options.designs:.2f}", "")
        table.add_row("", "iterations per design", f"{iterations / options.designs:.1f}", "")
        table.add_row("", "converged steps with non-finite values", f"{broken:,}", "")
        table.add_section()
    console = Console()
    console.print(machine(), markup=False)
    console.print(table)
    return 0 if good else 1


def worst(batch: Paths) -> list[str]:
    """Return the first unsuccessful status of each design, or `GOOD`."""
    names = []
    for words, stable in zip(batch.status.tolist(), batch.stable.tolist(), strict=True):
        bad = [word for word in words if word != "converged"]
        names.append(bad[0] if bad else GOOD if all(stable) else "unstable")
    return names


def not_finite(batch: Paths) -> int:
    """Count the converged steps with non-finite values."""
    finite = np.isfinite(batch.q).all(axis=2)
    for numbers in (batch.energy, batch.residual, batch.tip_force):
        finite &= np.isfinite(numbers)
    return int((batch.converged & ~finite).sum())


if __name__ == "__main__":
    sys.exit(main())
