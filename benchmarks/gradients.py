"""What exact gradients cost, how exact they are, and what they save, on all seven parameter sets.

Three tables: the processor time of value and gradient over that of the value alone, from random
designs followed on one thread; derivatives of joint angles and tip force along a random direction
against central differences of sixth order, at random designs that the engine calls regular and
whose stencil crosses no change of contact; and the designs that searches need for f_b within 1 %
(and 0.1 %) of the best value that any of them found.

Searches begin at the same random designs. Each is begun again from the next seed until all are
spent: the number is the designs of all seeds over the seeds that arrived (designs after the arrival
are not counted), which is what one has to expect with restarts.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from _differences import check
from _section import Section, table
from _timing import progress
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

import flexor
from flexor import optimizers
from flexor.design import ParameterSet, parameter_set
from flexor.model import Model
from flexor.optimizers import Search, SearchResult

SETS = ("L", "R01", "Rsc", "RLP", "L+R01", "L+Rsc", "L+RLP")
METHODS: dict[str, Search] = {
    "pattern search": optimizers.method("pattern-search"),
    "LM": optimizers.method("levenberg-marquardt"),
    "BFGS": optimizers.method("multistart-bfgs", starts=1),
    "BFGS, 8 starts": optimizers.method("multistart-bfgs"),
    "polished pattern": optimizers.method("pattern-search+polish"),
}
WITHIN = (0.01, 0.001)


def main() -> None:
    """Measure, and print the tables."""
    reading = argparse.ArgumentParser(description=__doc__)
    reading.add_argument("--designs", type=int, default=200, help="of each set")
    reading.add_argument("--runs", type=int, default=3, help="of the timing; medians are shown")
    reading.add_argument("--seeds", type=int, default=8, help="of each search")
    reading.add_argument("--budget", type=int, default=3000, help="designs of each search")
    asked = reading.parse_args()
    model, console = flexor.load("finger", "calibrated"), Console()
    section = measure(asked.designs, asked.runs)
    section.report()
    found = {name: searches(model, name, asked.seeds, asked.budget) for name in SETS}
    for within in WITHIN:
        saved = Table("set", "best f_b", *METHODS, "times fewer")
        for name, results in found.items():
            saved.add_row(name, *savings(results, within))
        console.print(f"Designs to within {within:.1%} of the best known f_b, {asked.seeds} seeds")
        console.print(saved)


def measure(designs: int, runs: int) -> Section:
    """Measure cost and error of gradients, and write it up."""
    made = table("set", "time", "regular", "compared", "median", "95 %", "worst", "above 1e-6")
    model = flexor.load("finger", "calibrated")
    with progress() as bar:
        for name in bar.track(SETS, description="gradients"):
            made.add_row(name, *accuracy(model, name, designs, runs))
    section = Section("Gradients", "./dev bench gradients")
    section.parts += [
        f"Value and gradient of {designs} random designs of each parameter set: *time*, processor "
        f"time over that of the value alone (median of {runs} runs); and relative errors of "
        "derivatives along a random direction against central differences of sixth order, at "
        "designs that the engine calls regular and whose stencil crosses no change of contact.",
        made,
    ]
    return section


def accuracy(model: Model, name: str, count: int, runs: int) -> list[str]:
    """Return the cells of a set's derivatives."""
    chosen = parameter_set(name, model.design)
    designs = random_designs(chosen, count)
    ratio = np.median([cost(model, chosen, designs) for _ in range(runs)])
    found = check(model, chosen, designs, seed=1, step=1e-5)
    errors = found.error[found.regular & found.smooth]
    quantiles = [f"{value:.1e}" for value in np.quantile(errors, (0.5, 0.95, 1.0))]
    above = int((errors > 1e-6).sum())
    return [f"{ratio:.2f}", str(found.regular.sum()), str(errors.size), *quantiles, str(above)]


def random_designs(chosen: ParameterSet, count: int) -> NDArray[np.float64]:
    """Draw designs from the whole of the bounds, (count, k)."""
    unit = np.random.default_rng(5).uniform(size=(count, chosen.size))
    return chosen.lower + unit * (chosen.upper - chosen.lower)


def cost(model: Model, chosen: ParameterSet, designs: NDArray[np.float64]) -> float:
    """Processor time of value and gradient, chained to the parameters, over that of the value."""
    geometry, seconds = chosen.geometry(designs, model.X), []
    for gradient in (False, True):
        began = time.process_time()
        batch = model.evaluate(geometry, threads=1, gradient=gradient)
        if gradient:
            batch.chained(chosen.jacobian(designs, model.X))
        seconds.append(time.process_time() - began)
    return seconds[1] / seconds[0]


def searches(model: Model, name: str, seeds: int, budget: int) -> dict[str, list[SearchResult]]:
    """Search with every method from the same random designs."""
    chosen, results = parameter_set(name, model.design), {}
    starts = random_designs(chosen, seeds)
    for label, method in METHODS.items():
        studies = [
            flexor.optimize(
                model, name, "bending", method, start=starts[seed], seed=seed, budget=budget
            )
            for seed in range(seeds)
        ]
        results[label] = [study.result for study in studies if study.result is not None]
    return results


def savings(results: dict[str, list[SearchResult]], within: float) -> list[str]:
    """Return the cells of a set's searches."""
    best = min(run.value for runs in results.values() for run in runs)
    needed = {label: expected(runs, best * (1.0 + within)) for label, runs in results.items()}
    cells = [
        f"{count:.0f} ({arrived}/{len(results[label])})" if arrived else "never"
        for label, (count, arrived) in needed.items()
    ]
    plain, *others = (count for count, _ in needed.values())
    return [f"{best:.4f}", *cells, f"{plain / min(others):.1f}"]


def expected(runs: list[SearchResult], target: float) -> tuple[float, int]:
    """Return the designs per arrival at a value, with restarts, and how many runs arrived."""
    spent = arrived = 0
    for run in runs:
        there = np.flatnonzero(run.improvement_values <= target)
        arrived += int(there.size > 0)
        spent += int(run.improvement_evaluations[there[0]]) if there.size else run.evaluations
    return (spent / arrived if arrived else np.inf), arrived


if __name__ == "__main__":
    main()
