"""Ten thousand random models of every kind: what is called stable must be a minimum of the energy.

Trees of rods and links with every joint, strain basis and section, springs, contacts, obstacles,
actuators, dead and follower forces, at lengths from 1e-6 to 1e3 m and forces from 1e-9 to 1e9 N,
follow loads that rise, fall, are held or jump. For every step that converged, the residual is
differenced at the state: central differences of fourth order, for several steps, which bounds the
error. The Hessian is equilibrated (the largest entry of each row is one). A state is wrong

* if it is called stable, and a real eigenvalue is below -1e-6 and below minus the error;
* if it is called unstable, and every eigenvalue of the symmetric part is above 1e-6 and above the
  error: then the real parts of all eigenvalues are positive, whatever the coordinates' units.

A state is undecided if the error is larger than the eigenvalue; a sphere that touches within the
difference makes such an error. The exit code is 1 if a state is wrong, if a number is not finite,
if a residual is above its tolerance, if a load step takes more than its iterations or more than
10 ms of processor time for each, or if an exception is raised. The model is then written to
`--keep`.

Model n depends on the seed and n only: `--first n --models 1` repeats it. The counts are saved in
`--state` after every 100 models, and the same command resumes from there.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from _machine import machine
from _random_models import Generator, RandomModel
from _resumed_count import engine, resumed, save
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from flexor._engine import STABILITY, STATUS
from flexor.errors import InputError
from flexor.model import Model
from flexor.model.reading import check

Array = NDArray[np.float64]
PART = 100
WRONG = -1e-6
CLEAR = 1e-3  # an eigenvalue above this is positive whatever the error
SYMMETRIC = 1e-6  # asymmetry of the Hessian of an energy
STEPS = (1e-4, 1e-3, 1e-5, 1e-6)
LONGEST = 0.01  # processor time for each iteration allowed [s]


@dataclass
class Count:
    """Counts so far."""

    seed: int
    limit: int
    engine: str
    first: int
    models: int = 0
    kinds: dict[str, int] = field(default_factory=dict)
    ends: dict[str, int] = field(default_factory=dict)
    states: dict[str, int] = field(default_factory=dict)
    undecided: int = 0
    events: int = 0
    seconds: float = 0.0
    slowest: list[float] = field(default_factory=lambda: [0.0, 0.0])
    failures: list[str] = field(default_factory=list)


def main(generator: type[Generator] = Generator, what: str = "models") -> int:
    """Follow the remaining models and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--models", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0, help="number of the first model")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit", type=int, default=2000, help="iterations of one load step")
    parser.add_argument("--state", type=Path, default=Path(f"stress-{what}.json"))
    parser.add_argument("--keep", type=Path, default=Path(f"stress-{what}"))
    options = parser.parse_args()
    fresh = Count(options.seed, options.limit, engine(), options.first)
    count = resumed(options.state, fresh, ("seed", "limit", "engine", "first"))
    with Progress(console=Console(stderr=True)) as progress:
        bar = progress.add_task("models", total=options.models, completed=count.models)
        while count.models < options.models:
            follow(count, count.first + count.models, options.keep, generator)
            count.models += 1
            if count.models % PART == 0 or count.models == options.models:
                save(options.state, count)
            progress.update(bar, completed=count.models)
    report(count)
    return 1 if count.failures else 0


def follow(count: Count, number: int, keep: Path, draws: type[Generator]) -> None:
    """Draw one model, follow its equilibria and check them."""
    random = np.random.default_rng([count.seed, number])
    generator = draws(random)
    made = generator.model()
    for kind in made.kinds:
        count.kinds[kind] = count.kinds.get(kind, 0) + 1
    try:
        model = Model(check(made.document, source=f"model {number}"))
    except InputError as error:
        section = ".section" in str(error) and " cannot be made: " in str(error)
        if section or " contains the base of " in str(error):
            count.ends["refused"] = count.ends.get("refused", 0) + 1
            return
        count.failures.append(f"model {number}: refused: {error}")
        return
    loads = generator.loads(model.inputs)
    began = time.thread_time()
    try:
        found = model.engine.path(
            np.empty(0, dtype=np.int64), np.empty((1, 0)), loads, 1, max_iterations=count.limit
        )
    except BaseException as error:  # a panic of the engine is no Exception
        if isinstance(error, KeyboardInterrupt):
            raise
        count.failures.append(f"model {number}: {type(error).__name__}: {error}")
        return
    seconds = time.thread_time() - began
    count.seconds += seconds
    count.slowest = max(count.slowest, [seconds, float(number)])
    count.events += len(found["events"]["design"])
    status = [STATUS[code] for code in found["status"][0]]
    end = next((each for each in status if each != "converged"), "converged")
    count.ends[end] = count.ends.get(end, 0) + 1
    failures = violations(found, count.limit)
    if seconds > LONGEST * count.limit * len(loads):
        failures.append(f"{seconds:.1f} s")
    for step, ended in enumerate(status):
        if ended not in ("converged", "unstable"):
            continue
        called = STABILITY[found["stability"][0][step]]
        count.states[called] = count.states.get(called, 0) + 1
        verdict = verdict_of(model, made, found["q"][0][step], loads[step], called)
        if verdict == "undecided":
            count.undecided += 1
        elif verdict:
            failures.append(f"step {step} is called {called}: {verdict}")
    if failures:
        count.failures += [f"model {number}: {each}" for each in failures]
        keep.mkdir(exist_ok=True)
        (keep / f"{number}.toml").write_text(model.file.to_toml())
        rows = dict(zip(model.inputs, loads.T.tolist(), strict=True))
        (keep / f"{number}.json").write_text(json.dumps({"loads": rows, "failures": failures}))


def violations(found: Any, limit: int) -> list[str]:
    """Return descriptions of numbers that must not occur."""
    violations = []
    good = np.isin(found["status"][0], [STATUS.index("converged"), STATUS.index("unstable")])
    finite = np.isfinite(found["q"][0]).all(axis=1)
    for numbers in ("energy", "residual", "tolerance", "tip_force"):
        finite &= np.isfinite(found[numbers][0])
    if (good & ~finite).any():
        violations.append("an equilibrium has a number that is not finite")
    converged = found["status"][0] == STATUS.index("converged")
    above = found["residual"][0] > found["tolerance"][0] * (1.0 + 1e-12)
    if (converged & above).any():
        violations.append("a step converged with a residual above its tolerance")
    # A minimisation is completed once it has started.
    if int(found["iterations"].max()) > 2 * limit + 40:
        violations.append(f"{found['iterations'].max()} iterations in a step")
    return violations


def verdict_of(model: Model, made: RandomModel, q: Array, load: Array, called: str) -> str:
    """Compare what a state is called with its differenced Hessian: ``""`` where they agree."""
    if called not in ("stable", "unstable") or len(q) == 0:
        return ""
    units = difference_units(model, made, q, load)
    hessian = differenced(model, q, load, STEPS[0] * units)
    scale = equilibrated(hessian)
    lowest = lowest_eigenvalue(hessian * np.outer(scale, scale))
    if called == "stable" and lowest > CLEAR:
        return ""
    # The error, from the two steps whose Hessians differ least.
    every = [hessian, *(differenced(model, q, load, step * units) for step in STEPS[1:])]
    error = np.inf
    for one, other in pairwise(every):
        difference = np.linalg.norm((one - other) * np.outer(scale, scale), 2)
        if difference < error:
            error, hessian = float(difference), other
    scaled = hessian * np.outer(scale, scale)
    lowest = lowest_eigenvalue(scaled)
    error *= 1.0 if is_symmetric(scaled) else 10.0
    if called == "stable" and lowest < WRONG:
        return f"eigenvalue {lowest:.2e} ± {error:.0e}" if lowest < -error else "undecided"
    if called == "unstable":
        lowest = float(np.linalg.eigvalsh(0.5 * (scaled + scaled.T))[0])
    if called == "unstable" and lowest > -WRONG:
        return f"eigenvalue {lowest:.2e} ± {error:.0e}" if lowest > error else "undecided"
    return ""


def difference_units(model: Model, made: RandomModel, q: Array, load: Array) -> Array:
    """Return what each coordinate is differenced over: about the same energy for each."""
    units = np.empty(len(q))
    angular = {joint["name"]: joint["unit"] == "rad" for joint in model.engine.joints}
    for i, name in enumerate(model.engine.coordinates):
        if name in angular:
            units[i] = 1.0 if angular[name] else made.length
        else:
            units[i] = 1.0  # a strain, or an angle between the rod's ends
    diagonal = np.abs(np.diag(differenced(model, q, load, 1e-4 * units)))
    energies = diagonal * units**2
    energy = energies[energies > 0.0].min(initial=np.inf)
    if np.isfinite(energy):
        held = energies > 0.0
        units[held] = np.minimum(units[held], np.sqrt(energy / diagonal[held]))
    return units


def differenced(model: Model, q: Array, load: Array, steps: Array) -> Array:
    """Difference the residual by each coordinate, to fourth order."""
    columns = np.empty((len(q), len(q)))
    for i, step in enumerate(steps.tolist()):
        sides = []
        for multiple in (1.0, 2.0):
            there = []
            for sign in (1.0, -1.0):
                moved = q.copy()
                moved[i] += sign * multiple * step
                there.append(model.engine.residual(model.parameters, moved, load))
            sides.append((there[0] - there[1]) / (2.0 * multiple * step))
        columns[:, i] = (4.0 * sides[0] - sides[1]) / 3.0
    return columns


def equilibrated(matrix: Array) -> Array:
    """Return scales by which the largest entry of each row and its column is one (Ruiz)."""
    scale = np.ones(len(matrix))
    for _ in range(30):
        size = np.abs(matrix) * np.outer(scale, scale)
        largest = np.maximum(size.max(axis=0), size.max(axis=1))
        scale /= np.sqrt(np.where(largest > 0.0, largest, 1.0))
    return scale


def is_symmetric(scaled: Array) -> bool:
    return bool(np.abs(scaled - scaled.T).max() < SYMMETRIC)


def lowest_eigenvalue(scaled: Array) -> float:
    """Return the lowest eigenvalue; of a matrix that is not symmetric, the lowest real one."""
    if not np.isfinite(scaled).all():
        return -np.inf
    if is_symmetric(scaled):
        return float(np.linalg.eigvalsh(0.5 * (scaled + scaled.T))[0])
    eigenvalues = np.linalg.eigvals(scaled)
    real = eigenvalues.real[np.abs(eigenvalues.imag) < 1e-9]
    return float(real.min(initial=np.inf))


def report(count: Count) -> None:
    """Print the tables."""
    console = Console()
    console.print(machine(), markup=False)
    tables = (("kind", "models", count.kinds), ("status", "models", count.ends))
    for heading, unit, counts in (*tables, ("stability", "states", count.states)):
        table = Table(heading, unit)
        table.columns[1].justify = "right"
        for name, number in sorted(counts.items(), key=lambda item: -item[1]):
            table.add_row(name, f"{number:,}")
        console.print(table)
    lines = (
        f"{count.models:,} models from number {count.first}, seed {count.seed}, "
        f"Flexor {count.engine}",
        f"at most {count.limit} iterations in a load step",
        f"processor time: {1e3 * count.seconds / max(count.models, 1):.1f} ms per model, at most "
        f"{1e3 * count.slowest[0]:.0f} ms (model {count.slowest[1]:.0f})",
        f"events: {count.events:,}",
        f"states undecided: {count.undecided}",
        f"failures: {len(count.failures)}",
        *count.failures[:40],
    )
    for line in lines:
        console.print(line, markup=False, highlight=False)


if __name__ == "__main__":
    sys.exit(main())
