"""Speed of evaluation: designs per second, iterations, time of one iteration.

Random designs: of L+R01 on the paper's finger, 0 to 5 N in 1 N steps and in a single step, on one
and two threads, with the calibrated constants and with a stiffer exosuit (E = 1 MPa, chamber on the
surface, k = 1000 N/m); of the problem that the strapped pneumatic finger of 20 elements states,
0 to 60 kPa in five steps; and of L+R01 on a spatial rod with all six strain modes. Cases are
interleaved and numbers are medians; the time of an iteration is processor time of one thread. The
column "undisturbed" sums the best times of batches of fifty designs, which excludes other load.
"""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Iterator
from functools import partial

import numpy as np
from _design_problems import DEMO, problem
from _random_designs import geometry, random_vectors
from _section import Section, table
from _timing import Times, progress
from numpy.typing import NDArray

import flexor
from flexor.design import Geometry
from flexor.model import Model, Paths, SlotValues, parse

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


STEPWISE, AT_ONCE = "0:5:1", "0:5:5"
PART = 50
Case = tuple[str, int]
Designs = Geometry | SlotValues


def cases(designs: int) -> Iterator[tuple[str, Model, int, tuple[Case, ...]]]:
    """Yield name, model, designs, and the forces with numbers of threads."""
    finger = ((STEPWISE, 1), (STEPWISE, 2), (AT_ONCE, 1), (AT_ONCE, 2))
    yield "finger, calibrated", flexor.load("finger", "calibrated"), designs, finger
    pressing = flexor.load("finger", "calibrated", PRESSING)
    yield "finger, E = 1 MPa, k = 1000 N/m", pressing, designs, finger
    device = flexor.load("pneumatic-finger")
    yield "pneumatic finger, Ogden", device, max(1, designs // 4), (("0:60:12 kPa", 1),)
    spatial = ((STEPWISE, 1), (AT_ONCE, 1))
    yield "spatial rod, six modes", Model(parse(SPATIAL)), max(1, designs // 10), spatial


def drawn(model: Model, count: int) -> tuple[Designs, list[Designs]]:
    """Draw random designs: all of them, and batch by batch.

    Of the problem that the model states, if it does, else of L+R01.
    """
    stated = model.file.design
    if stated is not None and stated.varied:
        own = problem(DEMO).parameters
        unit = np.random.default_rng(1).uniform(size=(count, own.size))
        vectors = own.lower + unit * (own.upper - own.lower)
        return own.designs(vectors, model)[0], [
            own.designs(vectors[i : i + PART], model)[0] for i in range(0, count, PART)
        ]
    vectors = random_vectors(model, count)
    parts = [geometry(model, vectors[i : i + PART]) for i in range(0, count, PART)]
    return geometry(model, vectors), parts


def main() -> None:
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--designs", type=int, default=2_000, help="number of designs of the finger"
    )
    parser.add_argument("--runs", type=int, default=5, help="number of runs; medians are reported")
    arguments = parser.parse_args()
    section = measure(arguments.designs, arguments.runs)
    section.report()


def measure(designs: int, runs: int) -> Section:
    """Run the benchmark and return its report."""
    speeds = table("model", "DOF", "step", "threads", "designs/s", "undisturbed", "µs/iteration")
    counts = table(
        "model",
        "step",
        "mean",
        "median",
        "designs that snap",
        "mean without snap",
        "mean with snap",
    )
    ratios = []
    with progress() as bar:
        for name, model, count, chosen in cases(designs):
            whole, parts = drawn(model, count)
            times = {case: Times() for case in chosen}
            best = {case[0]: np.full(len(parts), np.inf) for case in chosen}
            # Warms caches and threads, too.
            batches = {force: evaluated(model, whole, force, 2) for force, _ in chosen}
            for _ in bar.track(range(runs), description=name):
                for case in chosen:
                    force, threads = case
                    times[case].run(partial(evaluated, model, whole, force, threads))
                    if threads == 1:
                        part_by_part(model, parts, force, best[force])
            for case in chosen:
                force, threads = case
                alone = times[force, 1]
                speeds.add_row(
                    name if case == chosen[0] else "",
                    str(model.dof),
                    step(force),
                    str(threads),
                    f"{count / statistics.median(times[case].wall):,.0f}",
                    f"{count / best[force].sum():,.0f}" if threads == 1 else "",
                    f"{1e6 * alone.median / batches[force].iterations.sum():.1f}"
                    if threads == 1
                    else "",
                )
            for force, batch in batches.items():
                counts.add_row(name, step(force), *iterations(batch))
            if (STEPWISE, 2) in times:
                pairs = zip(times[STEPWISE, 1].wall, times[STEPWISE, 2].wall, strict=True)
                ratios.append(f"{name}: {statistics.median(a / b for a, b in pairs):.2f}")
    section = Section("Speed", "./dev bench speed")
    section.parts += [
        f"{designs:,} random designs (a quarter of these of the problem that the pneumatic finger "
        "states, 0 to 60 kPa in steps of 12 kPa; a tenth for the spatial rod), forces from 0 to "
        f"5 N in steps of 1 N and of 5 N; medians of {runs} runs. Designs per second are wall "
        "time, the time of an iteration is processor time of one thread; *undisturbed* uses the "
        f"best time of each batch of {PART} designs.",
        speeds,
        f"Speed-up with two threads, steps of 1 N: {'; '.join(ratios)}.",
        "Iterations (evaluations of the tangent) per design:",
        counts,
    ]
    return section


def iterations(batch: Paths) -> tuple[str, ...]:
    """Return mean and median, the share that snaps, and the means without and with."""
    each = batch.iterations.sum(axis=1)
    snaps = batch.event_count > 0
    means = [each, each[~snaps], each[snaps]]
    mean, calm, snapping = (f"{part.mean():.1f}" if part.size else "" for part in means)
    return mean, f"{np.median(each):.0f}", f"{100 * snaps.mean():.1f}%", calm, snapping


def step(force: str) -> str:
    """Return the step of a range with its unit."""
    size = force.rpartition(":")[2]
    return size if " " in size else f"{size} N"


def part_by_part(model: Model, parts: list[Designs], force: str, best: NDArray[np.float64]) -> None:
    """Evaluate batch after batch on one thread; keep the best wall time of each [s]."""
    for i, part in enumerate(parts):
        took = Times()
        took.run(partial(evaluated, model, part, force, 1))
        best[i] = min(best[i], took.wall[0])


def evaluated(model: Model, designs: Designs, force: str, threads: int) -> Paths:
    """Evaluate once."""
    batch = model.evaluate(designs, force, threads=threads)
    assert isinstance(batch, Paths)
    return batch


if __name__ == "__main__":
    main()
