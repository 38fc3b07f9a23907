"""Cost, accuracy and benefit of exact gradients on all seven parameter sets.

The first table has the processor time of value and gradient relative to that of the value alone,
for random designs on one thread, and the errors of derivatives of joint angles and tip force along
a random direction relative to central differences of sixth order, at random designs that the engine
reports as regular and whose stencil crosses no change of contact. The others have the evaluations
that searches need until f_b is within 1 % (and 0.1 %) of the best value found by any of them.

All searches start from the same random designs. The number of evaluations is the expected one with
restarts: the evaluations of all seeds, up to their success, divided by the number of successes.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import numpy as np
from _differences import TOLERANCE, WEIGHTS, check
from _section import Section, table
from _timing import progress
from _variables import VARIABLES
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

import flexor
from flexor import optimizers
from flexor.design import ParameterSet, parameter_set
from flexor.model import Model
from flexor.observables import observables
from flexor.optimizers import Search, SearchResult
from flexor.study import Problem

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
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=200, help="number of designs per set")
    parser.add_argument(
        "--runs", type=int, default=3, help="number of timed runs; medians are reported"
    )
    parser.add_argument("--seeds", type=int, default=8, help="number of seeds per method")
    parser.add_argument("--budget", type=int, default=3000, help="evaluations per search")
    options = parser.parse_args()
    model, console = flexor.load("finger", "calibrated"), Console()
    for section in (measure, observed):
        section(options.designs, options.runs).report()
    found = {name: searches(model, name, options.seeds, options.budget) for name in SETS}
    for within in WITHIN:
        saved = Table("set", "best f_b", *METHODS, "reduction factor")
        for name, results in found.items():
            saved.add_row(name, *savings(results, within))
        console.print(
            f"Evaluations until f_b is within {within:.1%} of the best, {options.seeds} seeds"
        )
        console.print(saved)


def measure(designs: int, runs: int) -> Section:
    """Measure cost and error of gradients; return the report."""
    made = table("set", "time", "regular", "compared", "median", "95 %", "worst", "above 1e-6")
    model = flexor.load("finger", "calibrated")
    with progress() as bar:
        for name in bar.track(SETS, description="gradients"):
            made.add_row(name, *accuracy(model, name, designs, runs))
    section = Section("Gradients", "./dev bench gradients")
    section.parts += [
        f"Value and gradient of {designs} random designs of each parameter set: *time*, processor "
        f"time relative to the value alone (median of {runs} runs); and relative errors of "
        "derivatives along a random direction with respect to sixth-order central differences, at "
        "designs that are regular and whose stencil crosses no change of contact.",
        made,
    ]
    return section


def observed(designs: int, runs: int) -> Section:
    """Measure cost and error of the gradients of all observables of a device; return the report."""
    made = table("observable", "regular", "compared", "median", "95 %", "worst", "above 1e-6")
    problem = device()
    chosen = problem.parameters
    vectors = random_designs(chosen, designs)
    ratio = np.median([device_cost(problem, vectors) for _ in range(runs)])
    own = stated()
    demo = np.median(
        [device_cost(own, random_designs(own.parameters, designs)) for _ in range(runs)]
    )
    tight = replace(problem, options={"tolerance": TOLERANCE})
    direction = np.random.default_rng(7).standard_normal(vectors.shape)
    direction *= (chosen.upper - chosen.lower) / np.linalg.norm(direction, axis=1, keepdims=True)
    here = tight.evaluate(vectors, gradient=True)
    exact = np.einsum("nck,nk->nc", here.constraint_gradients, direction)
    # Of each design relative to the largest component, so that a small one does not count.
    components = np.abs(here.constraint_gradients * (chosen.upper - chosen.lower)).max(axis=2)
    smooth = np.ones(len(vectors), dtype=np.bool_)
    differences = np.zeros_like(exact)
    for i, weight in enumerate(WEIGHTS):
        for sign in (1.0, -1.0):
            moved = tight.evaluate(vectors + sign * (i + 1) * 1e-4 * direction)
            differences += sign * weight * moved.constraint_values / 1e-4
            smooth &= (moved.touching == here.touching).all(axis=1)
            smooth &= moved.event_count == here.event_count
    units = np.array([each.observable(problem.model).unit[0] for each in problem.constraints])
    error = np.abs(exact - differences) / np.maximum(components, 1e-2 * units)
    for column, each in enumerate(problem.constraints):
        regular = here.constraint_regularity[:, column] == "regular"
        used = error[regular & smooth & ~np.isnan(error[:, column]), column]
        quantiles = (
            [f"{value:.1e}" for value in np.quantile(used, (0.5, 0.95, 1.0))]
            if used.size
            else ["–"] * 3
        )
        above = int((used > 1e-6).sum())
        made.add_row(each.name, str(regular.sum()), str(used.size), *quantiles, str(above))
    section = Section("Gradients of observables", "./dev bench gradients")
    section.parts += [
        f"Value and gradient of range of motion and of {len(problem.constraints)} constraints, one "
        f"on each observable, of {designs} random designs of `examples/pneumatic-finger.toml` with "
        f"{chosen.size} variables of every kind take {ratio:.2f} times the processor time of the "
        f"values alone (median of {runs} runs); with the example's own {own.parameters.size} "
        f"variables and {len(own.constraints)} constraints {demo:.2f} times. Errors are those of "
        "derivatives along a random direction with respect to sixth-order central differences, "
        "relative to the largest derivative by the range of a variable and to a hundredth of a "
        "display unit, at regular designs whose stencil crosses no change of contact. At rest all "
        "stretches are tied.",
        made,
    ]
    return section


def device() -> Problem:
    """Return the problem of a device: a constraint on every observable that has derivatives."""
    model = flexor.load("pneumatic-finger", changes={"exosuit.self_contact": False})
    bounds = []
    for name, each in observables(model).items():
        if each.differentiable:
            sense = ">=" if name == "min-stretch" else "<="
            bounds.append(f"{name} {sense} {1000 if sense == '<=' else 0} {each.unit[1]}".rstrip())
    return Problem.of(model, VARIABLES, "maximise range-of-motion", subject_to=bounds)


def stated() -> Problem:
    """Return the problem that the example states."""
    model = flexor.load("pneumatic-finger")
    design = model.file.design
    assert design is not None
    fields = {each.field: each.bounds for each in design.variable}
    return Problem.of(
        model, fields, f"maximise {design.maximise[0]}", subject_to=list(design.subject_to)
    )


def device_cost(problem: Problem, vectors: NDArray[np.float64]) -> float:
    """Return the processor time of values and gradients, relative to that of the values."""
    problem.evaluate(vectors[:1], 1, gradient=True)
    seconds = []
    for gradient in (False, True):
        began = time.process_time()
        problem.evaluate(vectors, 1, gradient)
        seconds.append(time.process_time() - began)
    return seconds[1] / seconds[0]


def accuracy(model: Model, name: str, count: int, runs: int) -> list[str]:
    """Return the table cells for the derivatives of a set."""
    chosen = parameter_set(name, model.design)
    designs = random_designs(chosen, count)
    ratio = np.median([cost(model, chosen, designs) for _ in range(runs)])
    found = check(model, chosen, designs, seed=1, step=1e-5)
    errors = found.error[found.regular & found.smooth]
    quantiles = [f"{value:.1e}" for value in np.quantile(errors, (0.5, 0.95, 1.0))]
    above = int((errors > 1e-6).sum())
    return [f"{ratio:.2f}", str(found.regular.sum()), str(errors.size), *quantiles, str(above)]


def random_designs(chosen: ParameterSet, count: int) -> NDArray[np.float64]:
    """Draw designs uniformly within the bounds, (count, k)."""
    unit = np.random.default_rng(5).uniform(size=(count, chosen.size))
    return chosen.lower + unit * (chosen.upper - chosen.lower)


def cost(model: Model, chosen: ParameterSet, designs: NDArray[np.float64]) -> float:
    """Return the processor time of value and gradient, relative to that of the value."""
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
    """Return the table cells for the searches of a set."""
    best = min(run.value for runs in results.values() for run in runs)
    needed = {label: expected(runs, best * (1.0 + within)) for label, runs in results.items()}
    cells = [
        f"{count:.0f} ({successes}/{len(results[label])})" if successes else "never"
        for label, (count, successes) in needed.items()
    ]
    plain, *others = (count for count, _ in needed.values())
    return [f"{best:.4f}", *cells, f"{plain / min(others):.1f}"]


def expected(runs: list[SearchResult], target: float) -> tuple[float, int]:
    """Return the expected evaluations until a value, with restarts, and the number of successes."""
    spent = successes = 0
    for run in runs:
        below = np.flatnonzero(run.improvement_values <= target)
        successes += int(below.size > 0)
        spent += int(run.improvement_evaluations[below[0]]) if below.size else run.evaluations
    return (spent / successes if successes else np.inf), successes


if __name__ == "__main__":
    main()
