"""Compare the speed of two builds of the engine, interleaved in one process.

On a busy machine two runs of the same benchmark may differ by 10 % or more. Here both engines
alternate on small batches of the same designs, and the best time of each batch counts; the
remaining variation between builds of the same method is about 1 %. Designs that snap or bifurcate
with either engine are also listed apart from the others, as they cost several times as much. Keep a
copy of the engine before building the new one:

    cp python/flexor/_engine_native.abi3.so old.so
    ./dev bench engines --against old.so
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from importlib.machinery import ExtensionFileLoader, ModuleSpec
from importlib.util import module_from_spec
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from _random_designs import random_designs
from _section import table
from _timing import progress
from rich.console import Console
from speed import PRESSING

import flexor
from flexor import _engine

PART = 25
RATIOS = "ratio", "iterations", "the other's"


def main() -> None:
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--against", type=Path, required=True, help="the other extension module")
    parser.add_argument(
        "--designs", type=int, default=800, help="number of designs per set of constants"
    )
    parser.add_argument("--runs", type=int, default=8, help="number of runs; the best time counts")
    arguments = parser.parse_args()
    try:
        engines = [load(arguments.against), _engine]
    except ImportError as error:
        parser.error(f"--against: {arguments.against} is not a build of the engine: {error}")
    found = table("constants", "step", "designs", "number", "µs each", "the other's", *RATIOS)
    for name, constants in (("calibrated", {}), ("E = 1 MPa", PRESSING)):
        model = flexor.load("finger", "calibrated", constants)
        slots, values = model.geometry_slots(random_designs(model, arguments.designs))
        models = [engine.Model(model._description) for engine in engines]
        for step in (1, 5):
            loads = np.arange(0.0, 5.1, step)[:, None]
            snapping = has_events(models, slots, values, loads)
            parts = {"no snap": values[~snapping], "snaps": values[snapping]}
            sums = np.zeros(2), np.zeros(2)
            for which, part in parts.items():
                title = f"{name}, {step} N, {which}"
                costs = by_parts(models, slots, part, loads, arguments.runs, title)
                found.add_row(name, f"{step} N", which, *numbers(len(part), *costs))
                for total, cost in zip(sums, costs, strict=True):
                    total += cost
            found.add_row(name, f"{step} N", "all", *numbers(len(values), *sums))
    Console().print(found)


def numbers(designs: int, times: np.ndarray, iterations: np.ndarray) -> Iterator[str]:
    """Yield the columns of a group of designs from the sums over it, of the other engine first."""
    yield str(designs)
    if designs == 0:
        return
    yield from (f"{1e6 * time / designs:,.0f}" for time in reversed(times))
    yield f"{times[0] / times[1]:.3f}"
    yield from (f"{count / designs:.1f}" for count in reversed(iterations))


def has_events(
    models: list[Any], slots: np.ndarray, values: np.ndarray, loads: np.ndarray
) -> np.ndarray:
    """Return for each design whether its path has an event with any of the engines, (n,)."""
    found = np.zeros(len(values), dtype=bool)
    for model in models:
        found[model.path(slots, values, loads, 1)["events"]["design"]] = True
    return found


def by_parts(
    models: list[Any],
    slots: np.ndarray,
    values: np.ndarray,
    loads: np.ndarray,
    runs: int,
    name: str,
) -> tuple[np.ndarray, np.ndarray]:
    """Return processor time [s] and iterations of each engine, alternating between batches."""
    starts = range(0, len(values), PART)
    times = np.full((len(models), len(starts), runs), np.inf)
    iterations = np.zeros(len(models))
    with progress() as bar:
        for run in bar.track(range(runs), description=name):
            for part, start in enumerate(starts):
                turns = range(len(models)) if (run + part) % 2 else reversed(range(len(models)))
                for which in turns:
                    before = time.thread_time()
                    designs = values[start : start + PART]
                    result = models[which].path(slots, designs, loads, 1)
                    times[which, part, run] = time.thread_time() - before
                    if run == 0:
                        iterations[which] += int(result["iterations"].sum())
    return times.min(axis=2).sum(axis=1), iterations


def load(path: Path) -> ModuleType:
    """Import an extension module by its file."""
    # The engine of version 0.1.0 has the short name.
    name = "_engine" if b"PyInit__engine\0" in path.read_bytes() else "_engine_native"
    loader = ExtensionFileLoader(name, str(path))
    spec = ModuleSpec(name, loader, origin=str(path))
    module = module_from_spec(spec)
    loader.exec_module(module)
    return module


if __name__ == "__main__":
    main()
