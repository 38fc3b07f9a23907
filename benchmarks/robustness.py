"""How 10,000 random designs end: every status, with both sets of constants.

Designs are drawn from the whole of the search bounds of L+R01 and followed from 0 to 5 N in 1 N
steps. A design counts by the worst that happened on its way; the exit code is 1 if a number of a
step that converged is not finite, or fewer than 99.9 % converged and are stable at every step.
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
    """Evaluate, and print the table."""
    reading = argparse.ArgumentParser(description=__doc__)
    reading.add_argument("--designs", type=int, default=10_000, help="of each set of constants")
    asked = reading.parse_args()
    table = Table("constants", "how designs end", "designs", "share")
    for column in table.columns[2:]:
        column.justify = "right"
    good = True
    for constants in ("calibrated", "printed"):
        model = flexor.load("finger", constants)
        vectors = random_vectors(model, asked.designs, seed=2)
        ends: Counter[str] = Counter()
        events = iterations = snapping = broken = 0
        parts = range(0, asked.designs, PART)
        for first in track(parts, f"{constants} constants", console=Console(stderr=True)):
            batch = model.evaluate(geometry(model, vectors[first : first + PART]))
            ends.update(worst(batch))
            events += int(batch.event_count.sum())
            snapping += int((batch.event_count > 0).sum())
            iterations += int(batch.iterations.sum())
            broken += not_finite(batch)
        good &= ends[GOOD] >= 0.999 * asked.designs and broken == 0
        for status, count in ends.most_common():
            table.add_row(constants, status, f"{count:,}", f"{count / asked.designs:.2%}")
            constants = ""
        table.add_row("", "of them with events", f"{snapping:,}", f"{snapping / asked.designs:.2%}")
        table.add_row("", "events per design", f"{events / asked.designs:.2f}", "")
        table.add_row("", "iterations per design", f"{iterations / asked.designs:.1f}", "")
        table.add_row("", "converged steps with a number not finite", f"{broken:,}", "")
        table.add_section()
    console = Console()
    console.print(machine(), markup=False)
    console.print(table)
    return 0 if good else 1


def worst(batch: Paths) -> list[str]:
    """Name the first status of each design that is not the good one."""
    names = []
    for words, stable in zip(batch.status.tolist(), batch.stable.tolist(), strict=True):
        bad = [word for word in words if word != "converged"]
        names.append(bad[0] if bad else GOOD if all(stable) else "unstable")
    return names


def not_finite(batch: Paths) -> int:
    """Count the converged steps of which any number is not finite."""
    finite = np.isfinite(batch.q).all(axis=2)
    for numbers in (batch.energy, batch.residual, batch.tip_force):
        finite &= np.isfinite(numbers)
    return int((batch.converged & ~finite).sum())


if __name__ == "__main__":
    sys.exit(main())
