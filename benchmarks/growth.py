"""How cost grows: with degrees of freedom, contact pairs, designs and threads; and memory.

Degrees of freedom by finer elements of the paper's exosuit on its finger, and of a rod in space
with all six strain modes, each followed from 0 to 5 N; contact pairs by more spheres on the finger,
softer in proportion; designs, in processes of their own, by a single small load step, which is
cheap enough for a million. Times are processor times of one thread, but for the speed on several
threads. Exponents a, cost ~ sizeᵃ, are fitted over the sizes that are said.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import statistics
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

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
QUICK_ELEMENTS = 6  # of each
SPHERES = (1, 3, 10, 30, 100, 300)  # on each of three links
DESIGNS = (1, 10, 100, 1_000, 10_000, 100_000, 1_000_000)
FORCES = (0.0, 0.1)  # N, for many designs
LARGE_DOF, LARGE_DESIGNS = 300, 100  # exponents are fitted from here on


@dataclass(frozen=True)
class Growth:
    """Cost over size; what a run was repeated for is its median."""

    sizes: list[int]
    costs: list[float]
    also: list[float]
    name: str = ""


def main() -> None:
    """Measure, and print the tables."""
    reading = argparse.ArgumentParser(description=__doc__)
    reading.add_argument("--runs", type=int, default=3, help="of which medians are shown")
    reading.add_argument("--quick", action="store_true", help="smaller sizes")
    reading.add_argument("--figure", type=Path, help="where to draw it (PNG, SVG or PDF)")
    asked = reading.parse_args()
    section = measure(asked.runs, quick=asked.quick)
    section.report()
    if asked.figure is not None:
        section.save(asked.figure)


def measure(runs: int, *, quick: bool) -> Section:
    """Measure everything, and write it up."""
    if not quick:
        Console(stderr=True).print("a million designs and 1,000 DOF: this takes some minutes")
    chosen = slice(QUICK_ELEMENTS) if quick else slice(None)
    dof = [
        degrees(name, make, elements[chosen], runs) for name, (make, elements) in ELEMENTS.items()
    ]
    pairs = contact_pairs(SPHERES[:-1] if quick else SPHERES, runs)
    time, memory = designs(DESIGNS[:-2] if quick else DESIGNS, runs)
    speed = threads(runs, 500 if quick else 2_000)
    section = Section("Growth", "./dev bench growth" + " --quick" * quick)
    section.parts += [
        "Processor time of one Newton iteration over degrees of freedom (DOF), with the exponent a "
        "of time ~ DOF^a from one size to the next; iterations are those of a design followed from "
        "0 to 5 N:",
        _degrees_table(dof),
        " ".join(_fit_sentence(growth) for growth in dof)
        + " Kinematics, potentials and the columns of each motion grow with DOF; below 96 strains "
        "the assembly pairs every coordinate with all before it, DOF², and Cholesky's "
        "factorisation is DOF³/6 multiplications; from there on both go from node to node "
        "(*Structure of the tangent*).",
        "Iteration over pairs of spheres that may touch, with those that do at 5 N:",
        _table("pairs", "touching", "µs/iteration", pairs, 1e6, "{:.1f}"),
        _pairs_sentence(pairs),
        f"Designs, each followed from 0 to {FORCES[1]} N in one step on one thread, and the most "
        "memory that the process used:",
        _designs_table(time, memory),
        f"From {LARGE_DESIGNS} designs on: time ~ designs^{_tail(time, LARGE_DESIGNS):.2f}; "
        f"memory {_slope(memory):.2f} kB for each design more.",
        "Designs a second, 0 to 5 N in 1 N steps (wall time):",
        _threads_table(speed),
    ]
    section.figure = draw(dof, pairs, time, memory, speed)
    section.caption = (
        "Growth: time of an iteration over degrees of freedom and over contact pairs; time and "
        "memory over designs; speed over threads."
    )
    return section


def degrees(name: str, make: Callable[[int], Model], elements: Sequence[int], runs: int) -> Growth:
    """Time an iteration over degrees of freedom."""
    models = [make(count) for count in elements]
    costs, iterations = _iterations(models, name, runs)
    return Growth([model.dof for model in models], costs, iterations, name)


def contact_pairs(spheres: Sequence[int], runs: int) -> Growth:
    """Time an iteration over pairs of spheres; `also` are those that touch, of each design."""
    models = [_bristling(count) for count in spheres]
    costs, _ = _iterations(models, "contact pairs", runs)
    tested = [3 * count * model.first_spheres for count, model in zip(spheres, models, strict=True)]
    touching = [float(model.evaluate(two_designs(model)).pairs[:, -1].mean()) for model in models]
    return Growth(tested, costs, touching, "contact pairs")


def _bristling(spheres: int) -> Model:
    """The finger with so many spheres on each of its three long links, and the skin as soft."""
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
    """Return the processor time of an iteration [s], and iterations for each design."""
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
    """Time [s] and peak memory [MB] over designs; the largest number is run once."""
    seconds, most = [], []
    with progress() as bar:
        for count in bar.track(counts, description="designs"):
            repeats = runs if count < 1_000_000 else 1
            found = list(_processes(count, repeats))
            seconds.append(statistics.median(second for second, _ in found))
            most.append(statistics.median(memory for _, memory in found))
    return Growth(list(counts), seconds, []), Growth(list(counts), most, [])


def _processes(count: int, repeats: int) -> Iterator[tuple[float, float]]:
    for _ in range(repeats):
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            yield pool.apply(_many, (count,))


def _many(count: int) -> tuple[float, float]:
    """Evaluate so many designs; return processor time [s] and the most memory used [MB]."""
    model, times = flexor.load("finger", "calibrated"), Times()
    geometry = random_designs(model, count)
    model.evaluate(random_designs(model, 1), FORCES, threads=1)
    times.run(lambda: model.evaluate(geometry, FORCES, threads=1))
    return times.median, peak()


def threads(runs: int, count: int) -> Growth:
    """Measure designs a second over threads; `also` is the ratio to one thread, run by run."""
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
    """Return kB for each design more, between the two largest numbers."""
    return 1e3 * (memory.costs[-1] - memory.costs[-2]) / (memory.sizes[-1] - memory.sizes[-2])


def _fit_sentence(growth: Growth) -> str:
    large = [size for size in growth.sizes if size >= LARGE_DOF]
    small = [i for i, size in enumerate(growth.sizes) if size < LARGE_DOF]
    below = exponent([growth.sizes[i] for i in small], [growth.costs[i] for i in small])
    text = f"{growth.name.capitalize()}: time of an iteration ~ DOF^{below:.2f} below {LARGE_DOF}"
    if len(large) > 1:
        text += f", ~ DOF^{_tail(growth, LARGE_DOF):.2f} from there to {large[-1]}"
    return text + "."


def _pairs_sentence(pairs: Growth) -> str:
    each = (pairs.costs[-1] - pairs.costs[0]) / (pairs.sizes[-1] - pairs.sizes[0])
    last = local_exponents(pairs.sizes, pairs.costs)[-1]
    return (
        f"That is {1e9 * each:.2f} ns for each pair more, those included that touch; between the "
        f"two largest numbers time ~ pairs^{last:.2f}, as the rest of the iteration still counts."
    )


def _degrees_table(dof: Sequence[Growth]) -> Table:
    made = table("model", "DOF", "iterations/design", "µs/iteration", "ms/design", "exponent")
    for growth in dof:
        exponents = [float("nan"), *local_exponents(growth.sizes, growth.costs)]
        rows = zip(growth.sizes, growth.also, growth.costs, exponents, strict=True)
        for i, (size, iterations, cost, local) in enumerate(rows):
            made.add_row(
                "" if i else growth.name,
                f"{size:,}",
                f"{iterations:.1f}",
                f"{1e6 * cost:,.1f}",
                f"{1e3 * cost * iterations:,.2f}",
                f"{local:.2f}" if i else "",
            )
    return made


def _table(size: str, also: str, cost: str, growth: Growth, factor: float, form: str) -> Table:
    made = table(size, also, cost, text=0)
    for number, other, value in zip(growth.sizes, growth.also, growth.costs, strict=True):
        made.add_row(f"{number:,}", f"{other:,.1f}", form.format(factor * value))
    return made


def _designs_table(time: Growth, memory: Growth) -> Table:
    made = table("designs", "seconds", "µs/design", "peak memory / MB", text=0)
    for count, seconds, most in zip(time.sizes, time.costs, memory.costs, strict=True):
        made.add_row(f"{count:,}", f"{seconds:.4f}", f"{1e6 * seconds / count:.1f}", f"{most:,.0f}")
    return made


def _threads_table(speed: Growth) -> Table:
    made = table("threads", "designs/s", "times one thread", text=0)
    for number, value, ratio in zip(speed.sizes, speed.costs, speed.also, strict=True):
        made.add_row(str(number), f"{value:,.0f}", f"{ratio:.2f}")
    return made


if __name__ == "__main__":
    main()
