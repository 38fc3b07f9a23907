"""How fast designs are evaluated: designs a second, iterations, memory.

Random designs of set L+R01 on the calibrated finger, 0 to 5 N in 1 N steps, on one thread and on
two; the time of one Newton iteration there and for a spatial rod of 66 degrees of freedom; the
memory that many designs take. Medians of three runs; the table says for which machine.
"""

from __future__ import annotations

import os
import platform
import statistics
import sys
import time

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

import flexor
from flexor.design import parameter_set
from flexor.model import Geometry, Model, parse

RUNS = 3
DESIGNS = 2_000
MANY = 100_000
PART = 1_024  # as studies evaluate

SPATIAL = """
name = "spatial"
[bodies.rod]
kind = "rod"
length = "20 cm"
radius = { base = "1.2 cm", tip = "0.8 cm" }
section = "circular"
young_modulus = "200 kPa"
poisson_ratio = 0.5
elements = 10
gauss_points = 3
[bodies.rod.strain]
twist_x = "nodal_linear"
bend_y = "nodal_linear"
bend_z = "nodal_linear"
extend_x = "nodal_linear"
shear_y = "nodal_linear"
shear_z = "nodal_linear"
[actuators.tendon]
kind = "cable"
rod = "rod"
path = { radius = "5 mm", start = "0 rad", turn = "2 rad" }
[design]
rod = "rod"
minimum_radius = "5 mm"
length_bounds = ["15 cm", "25 cm"]
radius_bounds = ["7 mm", "13 mm"]
[evaluation]
force = "5 N"
step = "1 N"
"""


def main() -> None:
    """Measure, and print the table."""
    finger = flexor.load("finger", constants="calibrated")
    spatial = Model(parse(SPATIAL))
    measurements = [(finger, threads, DESIGNS) for threads in (1, 2)] + [(spatial, 1, 200)]
    table = Table("model", "threads", "designs/s", "iterations/design", "µs/iteration")
    for column in table.columns[1:]:
        column.justify = "right"
    rates = []
    for model, threads, count in track(measurements, "measuring", console=Console(stderr=True)):
        geometry = random_designs(model, count)
        model.evaluate(geometry, threads=threads)  # warm caches and threads
        seconds, iterations = [], 0
        for _ in range(RUNS):
            began = time.perf_counter()
            batch = model.evaluate(geometry, threads=threads)
            seconds.append(time.perf_counter() - began)
            iterations = int(batch.iterations.sum())
        median = statistics.median(seconds)
        rates.append(count / median)
        table.add_row(
            f"{model.name}, {model.dof} DOF",
            str(threads),
            f"{rates[-1]:,.0f}",
            f"{iterations / count:.1f}",
            f"{1e6 * median * threads / iterations:.1f}",
        )
    console = Console()
    console.print(f"{machine()}; medians of {RUNS} runs", markup=False)
    console.print(table)
    console.print(f"two threads against one: {rates[1] / rates[0]:.2f} times as fast")
    kept = np.empty(MANY)
    for first in track(range(0, MANY, PART), f"{MANY:,} designs", console=Console(stderr=True)):
        batch = finger.evaluate(random_designs(finger, min(PART, MANY - first), seed=first))
        kept[first : first + PART] = batch.joint_angles[:, -1].sum(axis=1)
    console.print(
        f"peak memory of this process after {MANY:,} designs in batches of {PART:,}: "
        f"{peak_memory():.0f} MB"
    )


def random_designs(model: Model, count: int, seed: int = 1) -> Geometry:
    """Return random designs within the bounds of L+R01."""
    chosen = parameter_set("L+R01", model.design)
    unit = np.random.default_rng(seed).uniform(size=(count, chosen.size))
    return chosen.geometry(chosen.lower + unit * (chosen.upper - chosen.lower), model.X)


def peak_memory() -> float:
    """Return the most memory that this process has used [MB]."""
    if sys.platform == "win32":
        return float("nan")
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1e6 if sys.platform == "darwin" else 1e3)


def machine() -> str:
    """Return one line about the machine and the versions."""
    return (
        f"Flexor {flexor.__version__}, Python {platform.python_version()}, "
        f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores"
    )


if __name__ == "__main__":
    main()
