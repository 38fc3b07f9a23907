"""Two thousand random models with friction in every contact: what has to hold on any path.

The models are those of `stress_models.py` that have contacts or obstacles, each with a random
coefficient. Along their loads, which rise, fall, are held or jump, no force of friction exceeds
its limit, no energy comes from friction, a load that is held moves nothing, every number is finite
and every residual within its tolerance. The exit code is 1 if one of these does not hold or an
exception is raised. How the paths end is counted beside the same paths without friction.

Model n depends on the seed and n only: `--first n --models 1` repeats it.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from typing import Any

import numpy as np
from _machine import machine
from _random_models import Generator
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from rich.table import Table

from flexor._engine import STATUS
from flexor.errors import InputError
from flexor.model import Model
from flexor.model.reading import check

COEFFICIENTS = (0.1, 0.3, 0.6, 1.2)
ROUNDING = 1e-9  # of energies, relative to what is dissipated in all


def main() -> int:
    """Follow the models and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--models", type=int, default=2_000)
    parser.add_argument("--first", type=int, default=0, help="number of the first model")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit", type=int, default=2000, help="iterations of one load step")
    options = parser.parse_args()
    smooth, rough, failures = Counter[str](), Counter[str](), list[str]()
    numbers = range(options.first, options.first + options.models)
    for number in track(numbers, "models", console=Console(stderr=True)):
        ends, wrong = follow(number, options.seed, options.limit)
        failures += [f"model {number}: {each}" for each in wrong]
        if ends:
            smooth[ends[0]] += 1
            rough[ends[1]] += 1
    table = Table("paths end", "without friction", "with")
    for end in sorted({*smooth, *rough}):
        table.add_row(end, str(smooth[end]), str(rough[end]))
    console = Console()
    console.print(machine(), markup=False)
    console.print(table)
    console.print(f"failures: {len(failures)}", *failures, sep="\n", markup=False)
    return 1 if failures else 0


def follow(number: int, seed: int, limit: int) -> tuple[tuple[str, str] | None, list[str]]:
    """Follow one model; return how its paths without and with friction end, and what is wrong."""
    generator = Generator(np.random.default_rng([seed, number]))
    document = generator.model().document
    tables = [document[key] for key in ("contacts", "obstacles") if key in document]
    if not tables:
        return None, []
    try:
        smooth = Model(check(document, source=f"model {number}"))
    except InputError:
        return None, []  # those that cannot be made are those of stress_models.py
    random = np.random.default_rng([seed, number, 1])
    for table in tables:
        for each in table.values():
            each["friction"] = float(random.choice(COEFFICIENTS))
    rough = Model(check(document, source=f"model {number}"))
    loads = generator.loads(smooth.inputs)
    loads = np.vstack([loads, loads[-1:]])
    ends, wrong = [], list[str]()
    for model in (smooth, rough):
        try:
            found = model.engine.path(
                np.empty(0, dtype=np.int64), np.empty((1, 0)), loads, 1, max_iterations=limit
            )
        except BaseException as error:  # a panic of the engine is no Exception
            if isinstance(error, KeyboardInterrupt):
                raise
            return None, [f"{type(error).__name__}: {error}"]
        status = [STATUS[code] for code in found["status"][0]]
        ends.append(next((each for each in status if each != "converged"), "converged"))
        if model is rough:
            wrong = violations(found, status)
    return (ends[0], ends[1]), wrong


def violations(found: Any, status: list[str]) -> list[str]:
    """Return what does not hold along a path."""
    good = np.isin(status, ["converged", "unstable"])
    points, wrong = found["friction"], []
    if (np.linalg.norm(points["force"], axis=1) > points["limit"] * (1.0 + 1e-6)).any():
        wrong.append("a force of friction exceeds its limit")
    dissipated: NDArray[np.float64] = found["dissipated"][0][good]
    if (np.diff(dissipated) < -ROUNDING * dissipated.max(initial=0.0)).any():
        wrong.append("energy comes from friction")
    q = found["q"][0]
    if good[-2:].all() and not (q[-1] == q[-2]).all():
        wrong.append("a load that is held moves something")
    numbers = [found[name][0][good] for name in ("q", "energy", "residual", "dissipated")]
    if not all(np.isfinite(each).all() for each in numbers):
        wrong.append("an equilibrium has a number that is not finite")
    if (found["residual"][0] > found["tolerance"][0] * (1.0 + 1e-12))[good].any():
        wrong.append("a residual is above its tolerance")
    return wrong


if __name__ == "__main__":
    sys.exit(main())
