"""Scaling with degrees of freedom, contact pairs, designs and threads; and memory.

Degrees of freedom: the paper's exosuit on its finger with finer elements, and a spatial rod with
all six strain modes, from 0 to 5 N. Contact pairs: more spheres on the finger, with proportionally
lower stiffness. Designs: one small load step in a separate process, which is affordable for a
million designs. Times are processor times of one thread, except for the speed on several threads.
Exponents a of cost ~ sizeᵃ are fitted over the stated sizes.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import statistics
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

from _growth import Growth
from _growth_figure import draw
from _random_designs import random_designs
from _rods import finger, spatial_rod, two_designs
from _section import Section, table
from _timing import (
    Times,
    by_turns,
    enough,
    exponent,
    local_exponents,
    progress,
    repeated,
)
from memory import peak
from rich.console import Console
from rich.table import Table

import flexor
from flexor.model import Model

ELEMENTS = {
    "finger and exosuit": (finger, (4, 10, 20, 40, 80, 160, 320, 498)),
    "rod in space": (spatial_rod, (1, 3, 7, 15, 31, 63, 127, 166)),
}
QUICK_ELEMENTS = 6  # sizes per model with --quick
SPHERES = (1, 3, 10, 30, 100, 300)  # on each of three links
DESIGNS = (1, 10, 100, 1_000, 10_000, 100_000, 1_000_000)
FORCES = (0.0, 0.1)  # N, for many designs
LARGE_DOF, LARGE_DESIGNS = 300, 100  # lower limits of the fits of exponents


def main() -> None:
    """Run the benchmark and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=3, help="number of runs; medians are reported")
    parser.add_argument("--quick", action="store_true", help="smaller sizes")
    parser.add_argument("--figure", type=Path, help="file of the figure (PNG, SVG or PDF)")
    arguments = parser.parse_args()
    section = measure(arguments.runs, quick=arguments.quick)
    section.report()
    if arguments.figure is not None:
        section.save(arguments.figure)


def measure(runs: int, *, quick: bool) -> Section:
    """Run the benchmark and return its report."""
    if not quick:
        Console(stderr=True).print("a million designs and 1,000 DOF: this takes some minutes")
    chosen = slice(QUICK_ELEMENTS) if quick else slice(None)
    dof = [
        degrees(name, make, elements[chosen], runs) for name, (make, elements) in ELEMENTS.items()
    ]
    pairs = contact_pairs(SPHERES[:-1] if quick else SPHERES, runs)
    time, memory = designs(DESIGNS[:-2] if quick else DESIGNS, runs)
    speed = threads(runs, 500 if quick else 2_000)
    section = Section("Scaling", "./dev bench growth" + " --quick" * quick)
    section.parts += [
        "Processor time of one Newton iteration over degrees of freedom (DOF), with the exponent a "
        "of time ~ DOF^a between successive sizes; iterations per design are for a path from 0 to "
        "5 N:",
        _degrees_table(dof),
        " ".join(_fit_sentence(growth) for growth in dof)
        + " Kinematics, potentials and Jacobian columns are linear in DOF. Below 96 strains the "
        "assembly couples all pairs of coordinates, DOF², and the Cholesky factorisation takes "
        "DOF³/6 multiplications; from 96 strains on both are linear (*Structure of the tangent*).",
        "Time of an iteration over potential contact pairs, with the number in contact at 5 N:",
        _table("pairs", "in contact", "µs/iteration", pairs, 1e6, "{:.1f}"),
        _pairs_sentence(pairs),
        f"Batches of designs, each from 0 to {FORCES[1]} N in one step on one thread, with the "
        "peak "
        "memory of the process:",
        _designs_table(time, memory),
        f"From {LARGE_DESIGNS} designs on: time ~ designs^{_tail(time, LARGE_DESIGNS):.2f}; "
        f"memory {_slope(memory):.2f} kB per additional design.",
        "Designs per second, 0 to 5 N in 1 N steps (wall time):",
        _threads_table(speed),
    ]
    section.figure = draw(dof, pairs, time, memory, speed)
    section.caption = (
        "Scaling: time of an iteration over degrees of freedom and contact pairs; time and memory "
        "over designs; speed over threads."
    )
    return section


def degrees(name: str, make: Callable[[int], Model], elements: Sequence[int], runs: int) -> Growth:
    """Time an iteration over degrees of freedom."""
    models = [make(count) for count in elements]
    costs, iterations = _iterations(models, name, runs)
    return Growth([model.dof for model in models], costs, iterations, name)


def contact_pairs(spheres: Sequence[int], runs: int) -> Growth:
    """Time an iteration over pairs of spheres; `extra` are the pairs in contact per design."""
    models = [_many_spheres(count) for count in spheres]
    costs, _ = _iterations(models, "contact pairs", runs)
    tested = [3 * count * model.first_spheres for count, model in zip(spheres, models, strict=True)]
    touching = [float(model.evaluate(two_designs(model)).pairs[:, -1].mean()) for model in models]
    return Growth(tested, costs, touching, "contact pairs")


def _many_spheres(spheres: int) -> Model:
    """Return the finger with many spheres on its three long links, at equal total stiffness."""
    places = [
        {"body": f"ph_{link}", "at": (i + 0.5) / spheres}
        for link in (1, 2, 3)
        for i in range(spheres)
    ]
    changes: dict[str, object] = {
        "spheres.finger.bodies": [],
        "spheres.finger.points": places,
        "skin.stiffness": f"{77.1 * 8 / len(places)} N/m",
    }
    return flexor.load("finger", "calibrated", changes)


def _iterations(models: Sequence[Model], name: str, runs: int) -> tuple[list[float], list[float]]:
    """Return the processor time of an iteration [s] and the iterations per design."""
    works, counts = {}, {}
    for model in models:
        geometry = two_designs(model)
        work = partial(model.evaluate, geometry, threads=1)
        repeats = enough(work)
        counts[str(len(works))] = int(work().iterations.sum()), repeats
        works[str(len(works))] = repeated(work, repeats)
    times = by_turns(works, runs, name)
    costs = [times[key].median / (counts[key][0] * counts[key][1]) for key in works]
    return costs, [counts[key][0] / 2.0 for key in works]


def designs(counts: Sequence[int], runs: int) -> tuple[Growth, Growth]:
    """Measure time [s] and peak memory [MB] over designs; the largest batch is run once."""
    seconds, peaks = [], []
    with progress() as bar:
        for count in bar.track(counts, description="designs"):
            repeats = runs if count < 1_000_000 else 1
            samples = list(_processes(count, repeats))
            seconds.append(statistics.median(second for second, _ in samples))
            peaks.append(statistics.median(memory for _, memory in samples))
    return Growth(list(counts), seconds, []), Growth(list(counts), peaks, [])


def _processes(count: int, repeats: int) -> Iterator[tuple[float, float]]:
    for _ in range(repeats):
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            yield pool.apply(_evaluate, (count,))


def _evaluate(count: int) -> tuple[float, float]:
    """Evaluate random designs; return processor time [s] and peak memory [MB]."""
    model, times = flexor.load("finger", "calibrated"), Times()
    geometry = random_designs(model, count)
    model.evaluate(random_designs(model, 1), FORCES, threads=1)
    times.run(lambda: model.evaluate(geometry, FORCES, threads=1))
    return times.median, peak()


def threads(runs: int, count: int) -> Growth:
    """Measure designs per second over threads; `extra` is the speed-up over one thread."""
    cores = os.cpu_count() or 1
    numbers = sorted({1, cores, *(2**i for i in range(1, cores.bit_length()))} - {0})
    model = flexor.load("finger", "calibrated")
    geometry = random_designs(model, count)
    works = {str(n): partial(model.evaluate, geometry, threads=n) for n in numbers if n <= cores}
    times = by_turns(works, max(runs, 3), "threads")
    one = times["1"].wall
    ratios = [
        statistics.median(a / b for a, b in zip(one, times[n].wall, strict=True)) for n in works
    ]
    speeds = [count / statistics.median(times[n].wall) for n in works]
    return Growth([int(n) for n in works], speeds, ratios)


def _tail(growth: Growth, least: int) -> float:
    large = [i for i, size in enumerate(growth.sizes) if size >= least]
    return exponent([growth.sizes[i] for i in large], [growth.costs[i] for i in large])


def _slope(memory: Growth) -> float:
    """Return the memory per additional design [kB], from the two largest batches."""
    return 1e3 * (memory.costs[-1] - memory.costs[-2]) / (memory.sizes[-1] - memory.sizes[-2])


def _fit_sentence(growth: Growth) -> str:
    large = [size for size in growth.sizes if size >= LARGE_DOF]
    small = [i for i, size in enumerate(growth.sizes) if size < LARGE_DOF]
    below = exponent([growth.sizes[i] for i in small], [growth.costs[i] for i in small])
    text = f"{growth.name.capitalize()}: time of an iteration ~ DOF^{below:.2f} below {LARGE_DOF}"
    if len(large) > 1:
        text += f", ~ DOF^{_tail(growth, LARGE_DOF):.2f} from {LARGE_DOF} to {large[-1]}"
    return text + "."


def _pairs_sentence(pairs: Growth) -> str:
    each = (pairs.costs[-1] - pairs.costs[0]) / (pairs.sizes[-1] - pairs.sizes[0])
    last = local_exponents(pairs.sizes, pairs.costs)[-1]
    return (
        f"This is {1e9 * each:.2f} ns per additional pair, including those in contact; between the "
        f"two largest sizes time ~ pairs^{last:.2f}, as the rest of the iteration is significant."
    )


def _degrees_table(dof: Sequence[Growth]) -> Table:
    result = table("model", "DOF", "iterations/design", "µs/iteration", "ms/design", "exponent")
    for growth in dof:
        exponents = [float("nan"), *local_exponents(growth.sizes, growth.costs)]
        rows = zip(growth.sizes, growth.extra, growth.costs, exponents, strict=True)
        for i, (size, iterations, cost, local) in enumerate(rows):
            result.add_row(
                "" if i else growth.name,
                f"{size:,}",
                f"{iterations:.1f}",
                f"{1e6 * cost:,.1f}",
                f"{1e3 * cost * iterations:,.2f}",
                f"{local:.2f}" if i else "",
            )
    return result


def _table(size: str, extra: str, cost: str, growth: Growth, factor: float, form: str) -> Table:
    result = table(size, extra, cost, text=0)
    for number, other, value in zip(growth.sizes, growth.extra, growth.costs, strict=True):
        result.add_row(f"{number:,}", f"{other:,.1f}", form.format(factor * value))
    return result


def _designs_table(time: Growth, memory: Growth) -> Table:
    result = table("designs", "seconds", "µs/design", "peak memory / MB", text=0)
    for count, seconds, most in zip(time.sizes, time.costs, memory.costs, strict=True):
        result.add_row(
            f"{count:,}", f"{seconds:.4f}", f"{1e6 * seconds / count:.1f}", f"{most:,.0f}"
        )
    return result


def _threads_table(speed: Growth) -> Table:
    result = table("threads", "designs/s", "speed-up", text=0)
    for number, value, ratio in zip(speed.sizes, speed.costs, speed.extra, strict=True):
        result.add_row(str(number), f"{value:,.0f}", f"{ratio:.2f}")
    return result


if __name__ == "__main__":
    main()
