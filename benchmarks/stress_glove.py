"""A thousand random designs of the five-finger glove: each must end with a documented status.

Sizes of the actuators and the stiffness of joints are drawn independently for each finger: heights,
walls and floors from 0.7 to 1.5 times those of the example, lengths from 0.85 to 1.15, joints from
half as stiff to sixteen times, and for each input a pressure from 20 to 100 kPa. The exit code is 1
if a step has a status without a documented meaning, if a converged step has a number that is not
finite, if an exception is raised, or if less than 99 % of the designs converge at every load.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter

import numpy as np
from _machine import machine
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track

import flexor
from flexor.model import MEANINGS, Model

PART = 20
LEAST = 0.99
SHARES = {
    "exosuit.radius.base": (0.7, 1.5),
    "exosuit.radius.tip": (0.7, 1.5),
    "exosuit.section.wall": (0.7, 1.5),
    "exosuit.section.floor": (0.7, 1.5),
    "exosuit.length": (0.85, 1.15),
    "ph_1.joint.stiffness": (0.5, 16.0),
    "ph_2.joint.stiffness": (0.5, 16.0),
}
FINGERS = ("index", "middle", "ring", "little", "thumb")


def main() -> int:
    """Evaluate the designs and print the counts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=1_000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    model = flexor.load("glove")
    values = {f"{finger}.{field}": own for finger in FINGERS for field, own in SHARES.items()}
    bounds = {label: ends(label, shares, model) for label, shares in values.items()}
    chosen = flexor.design.variables(bounds, model)
    began = time.process_time()
    chosen.slots(model)
    first_design = time.process_time() - began
    random = np.random.default_rng(options.seed)
    statuses: Counter[str] = Counter()
    whole, events, failures, began = 0, 0, list[str](), time.process_time()
    for first in track(range(0, options.designs, PART), console=Console(stderr=True)):
        count = min(PART, options.designs - first)
        designs = chosen.lower + random.uniform(size=(count, chosen.size)) * (
            chosen.upper - chosen.lower
        )
        last = random.uniform(20e3, 100e3, size=(count, 1, len(model.inputs)))
        loads = last * np.linspace(0.0, 1.0, 6)[None, :, None]
        try:
            paths = model.evaluate(chosen.designs(designs, model)[0], loads)
        except Exception as error:
            failures.append(f"designs from {first}: {type(error).__name__}: {error}")
            continue
        good = paths.converged.all(axis=1)
        whole += int(good.sum())
        events += int(paths.event_count.sum())
        names = paths.status.ravel().tolist()
        statuses.update(names)
        failures += [f"undocumented status {name}" for name in set(names) - set(MEANINGS)]
        numbers: list[NDArray[np.float64]] = [paths.q, paths.energy[..., None], paths.volume]
        for numbers_of in numbers:
            if not np.isfinite(numbers_of[paths.converged]).all():
                failures.append(f"designs from {first}: a converged step is not finite")
    share = whole / options.designs
    if share < LEAST:
        failures.append(f"{share:.2%} of the designs converge at every load")
    seconds = time.process_time() - began
    console = Console()
    console.print(machine(), markup=False)
    lines = (
        f"{options.designs:,} designs, seed {options.seed}",
        f"converged at every load: {whole:,} ({share:.2%})",
        *(f"steps {name}: {number:,}" for name, number in statuses.most_common()),
        f"snaps: {events:,}",
        f"processor time: {first_design:.1f} s before the first design of {chosen.size} variables",
        f"processor time: {1e3 * seconds / options.designs:.1f} ms per design",
        f"failures: {len(failures)}",
        *failures[:20],
    )
    for line in lines:
        console.print(line, markup=False, highlight=False)
    return 1 if failures else 0


def ends(label: str, shares: tuple[float, float], model: Model) -> tuple[object, object]:
    """Return bounds of a field as multiples of its value."""
    from flexor.design.fields import keys_of, value_of

    value = value_of(keys_of(label, model.file), model.file)
    unit = "N*m/rad" if label.endswith("stiffness") else "m"
    low, high = (f"{share * float(value)!r} {unit}" for share in shares)
    return low, high


if __name__ == "__main__":
    sys.exit(main())
