"""How fast designs are evaluated: designs a second, iterations, time of one iteration.

Random designs of L+R01 on the paper's finger, 0 to 5 N in 1 N steps, on one thread and on two, with
the calibrated constants and with a softer exosuit that presses harder (E = 1 MPa, chamber on the
surface, k = 1000 N/m); and a spatial rod with all six strain modes. Threads take turns, and each
number is a median; an iteration's time is processor time of one thread.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Iterator

from _machine import machine
from _random_designs import random_designs
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

import flexor
from flexor.design import Geometry
from flexor.model import Model, parse

SPATIAL = """
name = "spatial rod"
[bodies.rod]
kind = "rod"
length = "20 cm"
radius = { base = "1.2 cm", tip = "0.8 cm" }
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
PRESSING = {
    "exosuit.young_modulus": "1 MPa",
    "chamber.lever": 1.0,
    "skin.stiffness": "1000 N/m",
}


def cases(designs: int) -> Iterator[tuple[str, Model, int, tuple[int, ...]]]:
    """Yield name, model, designs and numbers of threads."""
    yield "finger, calibrated", flexor.load("finger", "calibrated"), designs, (1, 2)
    pressing = flexor.load("finger", "calibrated", PRESSING)
    yield "finger, E = 1 MPa, k = 1000 N/m", pressing, max(1, designs // 10), (1, 2)
    yield "spatial rod, six modes", Model(parse(SPATIAL)), max(1, designs // 10), (1,)


def main() -> None:
    """Measure, and print the table."""
    reading = argparse.ArgumentParser(description=__doc__)
    reading.add_argument("--designs", type=int, default=2_000, help="of the calibrated finger")
    reading.add_argument("--runs", type=int, default=5, help="of which the median is printed")
    asked = reading.parse_args()
    table = Table("model", "DOF", "threads", "designs/s", "iterations/design", "µs/iteration")
    for column in table.columns[1:]:
        column.justify = "right"
    ratios = []
    with Progress(console=Console(stderr=True)) as progress:
        for name, model, count, threads in cases(asked.designs):
            geometry = random_designs(model, count)
            seconds = {number: list[float]() for number in threads}
            processor = list[float]()
            model.evaluate(geometry, threads=threads[-1])  # warm caches and threads
            for _ in progress.track(range(asked.runs), description=name):
                for number in threads:
                    wall, cpu, iterations = timed(model, geometry, number)
                    seconds[number].append(wall)
                    if number == 1:
                        processor.append(cpu / iterations)
            for number in threads:
                table.add_row(
                    name if number == 1 else "",
                    str(model.dof),
                    str(number),
                    f"{count / statistics.median(seconds[number]):,.0f}",
                    f"{iterations / count:.1f}",
                    f"{1e6 * statistics.median(processor):.1f}" if number == 1 else "",
                )
            if len(threads) > 1:
                pairs = zip(seconds[1], seconds[2], strict=True)
                ratios.append(f"{name}: {statistics.median(a / b for a, b in pairs):.2f}")
    console = Console()
    console.print(f"{machine()}; medians of {asked.runs} runs", markup=False)
    console.print(table)
    console.print(f"two threads against one: {'; '.join(ratios)}")


def timed(model: Model, geometry: Geometry, threads: int) -> tuple[float, float, int]:
    """Return wall time, processor time [s] and Newton iterations of one evaluation."""
    wall, cpu = time.perf_counter(), time.process_time()
    batch = model.evaluate(geometry, threads=threads)
    return time.perf_counter() - wall, time.process_time() - cpu, int(batch.iterations.sum())


if __name__ == "__main__":
    main()
