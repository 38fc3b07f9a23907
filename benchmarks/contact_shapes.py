"""Effect of round cones compared with spheres.

For random designs of L+R01 to 5 N in 1 N steps: the number of snaps and of iterations. Along a fine
line of designs, with the length from bound to bound at fixed radii: the roughness of f_b, as its
deviation from a moving parabola.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from _machine import machine
from _random_designs import geometry, random_vectors
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from rich.table import Table

import flexor
from flexor.model import Model

PART = 50
WINDOW = 41  # designs under the moving parabola
RADII = (0.0067, 0.0075)  # the paper's optimum of R_0 and R_1 [m]
SYSTEMS: dict[str, tuple[str, dict[str, str]]] = {
    "calibrated": ("calibrated", {}),
    "1 MPa, 1000 N/m": (
        "printed",
        {"exosuit.young_modulus": "1 MPa", "skin.stiffness": "1000 N/m"},
    ),
}
SHAPES = ("spheres", "round-cones")


def main() -> None:
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=1_000, help="number of random designs")
    parser.add_argument("--line", type=int, default=801, help="designs on the line")
    arguments = parser.parse_args()
    table = Table("", *(f"{system}: {shape}" for system in SYSTEMS for shape in SHAPES))
    for column in table.columns[1:]:
        column.justify = "right"
    rows: dict[str, list[str]] = {}
    for system, (constants, changes) in SYSTEMS.items():
        for shape in SHAPES:
            model = flexor.load("finger", constants, changes={**changes, "skin.shape": shape})
            found = facts(model, arguments.designs, arguments.line, f"{system}: {shape}")
            for name, value in found.items():
                rows.setdefault(name, []).append(value)
    for name, values in rows.items():
        table.add_row(name, *values)
    console = Console(width=130)
    console.print(machine(), markup=False)
    console.print(table)


def facts(model: Model, designs: int, line: int, title: str) -> dict[str, str]:
    """Return the rows of one column."""
    vectors = random_vectors(model, designs, seed=3)
    snaps, iterations, converged, seconds = np.zeros(designs), np.zeros(designs), 0, 0.0
    for first in track(range(0, designs, PART), title, console=Console(stderr=True)):
        chosen = vectors[first : first + PART]
        start = time.process_time()
        batch = model.evaluate(geometry(model, chosen), "0:5:1", threads=1)
        seconds += time.process_time() - start
        snaps[first : first + PART] = batch.event_count
        iterations[first : first + PART] = batch.iterations.sum(axis=1)
        converged += int(batch.converged.all(axis=1).sum())
    angle = bending_along_a_line(model, line)
    return {
        "designs": f"{designs:,}",
        "converged at every load": f"{converged:,}",
        "snaps": f"{int(snaps.sum()):,}",
        "designs with a snap": f"{int((snaps > 0).sum()):,}",
        "iterations per design, median": f"{np.median(iterations):.0f}",
        "iterations per design, mean": f"{iterations.mean():.1f}",
        "processor time per design / ms": f"{1e3 * seconds / designs:.2f}",
        "bending on the line / rad": f"{angle.min():.3f} to {angle.max():.3f}",
        "roughness of the line / mrad": f"{1e3 * roughness(angle):.2f}",
        "local extrema of the line": f"{extrema(angle):,}",
    }


def bending_along_a_line(model: Model, count: int) -> NDArray[np.float64]:
    """Return f_b at 5 N of designs from the shortest to the longest, (count,) [rad]."""
    low, high = model.design.length_bounds
    vectors = np.column_stack([np.linspace(low, high, count), np.tile(RADII, (count, 1))])
    batch = model.evaluate(geometry(model, vectors), "0:5:1")
    return batch.joint_angles[:, -1].sum(axis=1)


def roughness(values: NDArray[np.float64]) -> float:
    """Return the RMS deviation of values from a moving parabola."""
    windows = np.lib.stride_tricks.sliding_window_view(values, WINDOW)
    x = np.linspace(-1.0, 1.0, WINDOW)
    basis = np.linalg.qr(np.vander(x, 3))[0]
    rest = windows - windows @ basis @ basis.T
    return float(np.sqrt(np.mean(rest[:, WINDOW // 2] ** 2)))


def extrema(values: NDArray[np.float64]) -> int:
    """Count the local extrema of a sequence."""
    return int((np.diff(np.sign(np.diff(values))) != 0).sum())


if __name__ == "__main__":
    main()
