"""One million designs far outside the search bounds: each must end with a status in bounded time.

Lengths and radii are drawn up to ten times beyond the search bounds on either side, contact and
joint stiffnesses and Young's modulus over six decades, the lever over two, the load up to ±100 N in
up to five steps. 2 % of the designs have an invalid value such as NaN, zero or 1e300; 10 % are
differentiated as well. A design is counted by the first step that did not converge. The exit code
is 1 if a converged step has a value that is not finite, if a step exceeds its iterations, if a
design takes more than 10 ms of processor time per iteration allowed in a step, if a design with a
value that is not finite is accepted, or if an exception is raised.

The designs of a chunk depend on the seed and its number only. The counts are saved in `--state`
after each chunk, and the same command resumes from there.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from _machine import machine
from _resumed_count import engine, resumed, save
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table

import flexor
from flexor._engine import STATUS
from flexor.model import Model
from flexor.model.geometry import SlotValues

Array = NDArray[np.float64]
PART = 500
# Most designs are of the model that is usually optimised; the last model is spatial.
MODELS = {"finger": 0.8, "finger-2-links": 0.1, "tendon-arm": 0.1}
INVALID = (0.0, -1.0, np.nan, np.inf, -np.inf, 5e-324, 1e-300, 1e300)
LONGEST = 0.01  # processor time of a design for each iteration allowed in a load step [s]
NONE = np.empty(0, dtype=np.int64), np.empty((1, 0))


@dataclass
class Count:
    """Counts so far."""

    seed: int
    limit: int
    engine: str
    parts: int = 0
    ends: dict[str, dict[str, int]] = field(default_factory=dict)
    seconds: float = 0.0
    slowest: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    most_iterations: int = 0
    events: int = 0
    failures: list[str] = field(default_factory=list)


def main() -> int:
    """Evaluate the remaining chunks and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit", type=int, default=100, help="iterations of one load step")
    parser.add_argument("--state", type=Path, default=Path("stress-designs.json"))
    options = parser.parse_args()
    fresh = Count(options.seed, options.limit, engine())
    count = resumed(options.state, fresh, ("seed", "limit", "engine"))
    models = [flexor.load(name) for name in MODELS]
    parts = -(-options.designs // PART)
    console = Console(stderr=True)
    columns = (TextColumn("designs"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, TimeRemainingColumn(), console=console) as progress:
        bar = progress.add_task("", total=parts * PART, completed=count.parts * PART)
        while count.parts < parts:
            evaluate(count, models)
            save(options.state, count)
            progress.update(bar, completed=count.parts * PART)
    report(count)
    return 1 if count.failures else 0


def evaluate(count: Count, models: list[Model]) -> None:
    """Evaluate and count one chunk."""
    random = np.random.default_rng([count.seed, count.parts])
    which = random.choice(len(models), size=PART, p=list(MODELS.values()))
    for row, index in enumerate(which.tolist()):
        model = models[index]
        parameters, loads = extreme_design(model, random)
        valid = not invalidate(parameters, random) if random.uniform() < 0.02 else True
        differentiated = random.uniform() < 0.1
        name = f"{model.name}, design {row} of part {count.parts}"
        began = time.thread_time()
        try:
            found = model.engine.path(*NONE, loads, 1, base=parameters, max_iterations=count.limit)
            if differentiated:
                every = SlotValues(np.arange(len(parameters)), parameters[None])
                paths = model.evaluate(every, loads, 1, gradient=True, max_iterations=count.limit)
                found |= {"gradient": paths.gradient, "regularity": paths.regularity}
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt):
                raise
            count.failures.append(f"{name}: {type(error).__name__}: {error}")
            continue
        seconds = time.thread_time() - began
        if seconds > LONGEST * count.limit:
            count.failures.append(f"{name}: {seconds:.1f} s")
        count.seconds += seconds
        if seconds > count.slowest[0]:
            count.slowest = [seconds, float(count.parts), float(row)]
        count.events += len(found["events"]["design"])
        count.most_iterations = max(count.most_iterations, int(found["iterations"].max()))
        for what in violations(found, valid, count.limit):
            count.failures.append(f"{name}: {what}")
        ends = count.ends.setdefault(model.name, {})
        end = first_failure(found["status"][0].tolist(), len(found["events"]["design"]))
        ends[end] = ends.get(end, 0) + 1
    count.parts += 1


def extreme_design(model: Model, random: np.random.Generator) -> tuple[Array, Array]:
    """Draw parameters (P,) and loads (steps, 1) far outside the usual range."""
    parameters, space = model.parameters.copy(), model.design
    slots = model.engine.slots

    def logarithmic(low: float, high: float) -> float:
        return float(low * (high / low) ** random.uniform())

    radius = [logarithmic(0.1 * space.radius_bounds[0], 10 * space.radius_bounds[1]) for _ in "bt"]
    wave = random.uniform(-0.5, 0.5) * min(radius)  # added to the linear profile
    turns = np.pi * random.integers(1, 6)
    X = space.points
    surface = radius[0] + (radius[1] - radius[0]) * X + wave * np.sin(turns * X)
    slope = radius[1] - radius[0] + wave * turns * np.cos(turns * X)
    values: dict[str, Array | float] = {
        f"{space.rod}.length": logarithmic(
            0.1 * space.length_bounds[0], 10 * space.length_bounds[1]
        ),
        f"{space.rod}.radius": surface,
        f"{space.rod}.slope": slope,
        f"{space.rod}.young_modulus": logarithmic(1e3, 1e9),
        f"{space.rod}.shear_modulus": logarithmic(1e3, 1e9),
    }
    for name, (start, stop) in slots.items():
        if name.endswith(".joint_stiffness") and stop > start:
            values[name] = np.array([logarithmic(1e-5, 10.0) for _ in range(start, stop)])
        elif name.endswith(".stiffness"):
            values[name] = logarithmic(0.1, 1e5)
        elif name.endswith(".lever"):
            values[name] = parameters[start:stop] * logarithmic(0.1, 10.0)
    if random.uniform() < 0.5:  # on the finger, as in a search, or anywhere near it
        height = 0.0216 + radius[0] if "finger" in model.name else 0.0
    else:
        height = random.uniform(-0.1, 0.1)
    start, _ = slots[f"{space.rod}.translation"]
    parameters[start + 2] = height
    for name, value in values.items():
        parameters[slice(*slots[name])] = value
    last = logarithmic(0.1, 100.0) * (1.0 if random.uniform() < 0.8 else -1.0)
    return parameters, np.linspace(0.0, last, int(random.integers(2, 7)))[:, None]


def invalidate(parameters: Array, random: np.random.Generator) -> bool:
    """Set a random parameter to an invalid value; return whether the engine must reject it."""
    place, value = int(random.integers(len(parameters))), float(random.choice(INVALID))
    parameters[place] = value
    return not np.isfinite(value)


def violations(found: dict[str, Any], valid: bool, limit: int) -> list[str]:
    """Return descriptions of results that must not occur."""
    violations = []
    status = found["status"][0]
    good = status == STATUS.index("converged")
    finite = np.isfinite(found["q"][0]).all(axis=1)
    for numbers in ("energy", "residual", "tip_force"):
        finite &= np.isfinite(found[numbers][0])
    if (good & ~finite).any():
        violations.append("a step converged with a number that is not finite")
    if status.max() >= len(STATUS):
        violations.append(f"status {status.max()}")
    # A trial sub-step or a minimisation is completed once it has started.
    if int(found["iterations"].max()) > 2 * limit + 40:
        violations.append(f"{found['iterations'].max()} iterations in a step")
    if not valid and (status != STATUS.index("invalid-design")).any():
        violations.append("a parameter that is not finite was accepted")
    regular = "gradient" in found and found["regularity"][0] == "regular"
    if regular and not np.isfinite(found["gradient"]).all():
        violations.append("a regular gradient is not finite")
    for numbers in ("before", "after", "load"):
        if not np.isfinite(found["events"][numbers]).all():
            violations.append("an event has a number that is not finite")
    return violations


def first_failure(codes: list[int], events: int) -> str:
    """Return the status of the first step that did not converge, or a word for success."""
    names = [STATUS[code] for code in codes if STATUS[code] != "converged"]
    return names[0] if names else "converged, with snaps" if events else "converged"


def report(count: Count) -> None:
    """Print the table."""
    designs = sum(sum(ends.values()) for ends in count.ends.values())
    table = Table("model", "status", "designs", "share")
    for column in table.columns[2:]:
        column.justify = "right"
    whole: Counter[str] = Counter()
    for ends in count.ends.values():
        whole.update(ends)
    for model, ends in [("all", dict(whole)), *count.ends.items()]:
        total = sum(ends.values())
        for end, number in sorted(ends.items(), key=lambda item: -item[1]):
            table.add_row(model, end, f"{number:,}", f"{number / total:.3%}")
            model = ""
        table.add_section()
    console = Console()
    console.print(machine(), markup=False)
    console.print(table)
    seconds, part, row = count.slowest
    lines = (
        f"{designs:,} designs, seed {count.seed}, Flexor {count.engine}",
        f"at most {count.limit} iterations in a load step",
        f"processor time: {1e3 * count.seconds / designs:.2f} ms per design, at most "
        f"{1e3 * seconds:.0f} ms (design {row:.0f} of part {part:.0f})",
        f"most iterations of a load step: {count.most_iterations}",
        f"snaps: {count.events:,}",
        f"failures: {len(count.failures)}",
        *count.failures[:20],
    )
    for line in lines:
        console.print(line, markup=False, highlight=False)


if __name__ == "__main__":
    sys.exit(main())
