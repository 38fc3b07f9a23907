"""How fast designs are evaluated: designs a second, iterations, time of one iteration.

Random designs of L+R01 on the paper's finger, 0 to 5 N in 1 N steps, on one thread and on two, with
the calibrated constants and with a softer exosuit that presses harder (E = 1 MPa, chamber on the
surface, k = 1000 N/m); and a spatial rod with all six strain modes. Threads take turns, and each
number is a median; an iteration's time is processor time of one thread.
"""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Iterator

from _random_designs import random_designs
from _section import Section, table
from _timing import Times, progress

import flexor
from flexor.design import Geometry
from flexor.model import Batch, Model, parse

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
    section = measure(asked.designs, asked.runs)
    section.report()


def measure(designs: int, runs: int) -> Section:
    """Measure everything, and write it up."""
    made = table("model", "DOF", "threads", "designs/s", "iterations/design", "µs/iteration")
    ratios = []
    with progress() as bar:
        for name, model, count, threads in cases(designs):
            geometry = random_designs(model, count)
            times = {number: Times() for number in threads}
            model.evaluate(geometry, threads=threads[-1])  # warm caches and threads
            for _ in bar.track(range(runs), description=name):
                for number in threads:
                    iterations = timed(model, geometry, number, times[number])
            for number in threads:
                made.add_row(
                    name if number == 1 else "",
                    str(model.dof),
                    str(number),
                    f"{count / statistics.median(times[number].wall):,.0f}",
                    f"{iterations / count:.1f}",
                    f"{1e6 * times[1].median / iterations:.1f}" if number == 1 else "",
                )
            if len(threads) > 1:
                pairs = zip(times[1].wall, times[2].wall, strict=True)
                ratios.append(f"{name}: {statistics.median(a / b for a, b in pairs):.2f}")
    section = Section("Speed", "./dev bench speed")
    section.parts += [
        f"Random designs, 0 to 5 N in 1 N steps; medians of {runs} runs. Designs a second are of "
        "wall time, an iteration is processor time of one thread.",
        made,
        f"Two threads against one: {'; '.join(ratios)}.",
    ]
    return section


def timed(model: Model, geometry: Geometry, threads: int, times: Times) -> int:
    """Evaluate once, and return the Newton iterations."""
    batch = times.run(lambda: model.evaluate(geometry, threads=threads))
    assert isinstance(batch, Batch)
    return int(batch.iterations.sum())


if __name__ == "__main__":
    main()
