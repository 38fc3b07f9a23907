"""How 10,000 random designs end: every status, with both sets of constants.

Designs are drawn from the whole of the search bounds of L+R01 and followed from 0 to 5 N in 1 N
steps. Printed are the designs by the worst status along their path, and how many are stable
throughout; the exit code is 1 if a number is not finite.
"""

from __future__ import annotations

import sys
from collections import Counter

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

import flexor
from flexor._engine import STATUS
from flexor.design import parameter_set

DESIGNS = 10_000
PART = 500


def main() -> int:
    """Evaluate, and print the table."""
    table = Table("constants", "status", "designs", "share")
    for column in table.columns[2:]:
        column.justify = "right"
    finite = True
    for constants in ("calibrated", "printed"):
        model = flexor.load("finger", constants=constants)
        chosen = parameter_set("L+R01", model.design)
        unit = np.random.default_rng(2).uniform(size=(DESIGNS, chosen.size))
        designs = chosen.lower + unit * (chosen.upper - chosen.lower)
        ends: Counter[str] = Counter()
        parts = range(0, DESIGNS, PART)
        for first in track(parts, f"{constants} constants", console=Console(stderr=True)):
            geometry = chosen.geometry(designs[first : first + PART], model.X)
            batch = model.evaluate(geometry)
            finite &= bool(np.isfinite(batch.q).all() and np.isfinite(batch.energy).all())
            for statuses, stable in zip(batch.status, batch.stable, strict=True):
                worst = next((STATUS[code] for code in statuses if STATUS[code] != "converged"), "")
                ends[worst or ("converged, stable" if stable.all() else "converged, unstable")] += 1
            snaps = len(set(batch.events["design"].tolist()))
            ends["(with a snap on the way)"] += snaps
        for status, count in sorted(ends.items(), key=lambda item: (item[0][0] == "(", -item[1])):
            table.add_row(constants, status, f"{count:,}", f"{100.0 * count / DESIGNS:.2f} %")
    console = Console()
    console.print(table)
    console.print("every number is finite" if finite else "some numbers are not finite")
    return 0 if finite else 1


if __name__ == "__main__":
    sys.exit(main())
