"""Cost of a model that is made of parts against that of one part, in interleaved runs.

Gloves of one to eight equal fingers, each with its own pressure and its own random designs of its
actuator, each followed to its last load, against one finger by itself, which is planar. For
comparison gloves whose fingers are followed in space, and as one system.
"""

from __future__ import annotations

import argparse
import statistics
from collections.abc import Callable

import numpy as np
from _machine import machine
from _timing import by_turns
from rich.console import Console
from rich.table import Table

import flexor
from flexor.model import Model, SlotValues, parse
from flexor.model.separate import Separate

FINGERS = (1, 2, 3, 5, 8)
IN_SPACE = 5  # fingers whose planes are not made use of
AS_ONE = 3  # fingers followed as one system, which takes long
FIELDS = {
    "exosuit.radius.base": ("5 mm", "8 mm"),
    "exosuit.radius.tip": ("4.5 mm", "7 mm"),
    "exosuit.section.wall": ("1.2 mm", "2.5 mm"),
}


def main() -> None:
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=60, help="number of random designs")
    parser.add_argument("--runs", type=int, default=5)
    arguments = parser.parse_args()
    designs = arguments.designs
    works = {"1 by itself": work(0, designs)}
    works |= {f"{count}": work(count, designs) for count in FINGERS}
    works[f"{IN_SPACE} in space"] = work(IN_SPACE, designs, in_space)
    works[f"{AS_ONE} as one system"] = work(AS_ONE, designs, as_one)
    times = by_turns(works, arguments.runs, "fingers")
    base = times["1 by itself"].cpu
    table = Table("fingers", "ms per design", "times one by itself (median, range)")
    for name, each in times.items():
        ratios = [own / one for own, one in zip(each.cpu, base, strict=True)]
        table.add_row(
            name,
            f"{1e3 * each.median / designs:.2f}",
            f"{statistics.median(ratios):.2f}   {min(ratios):.2f} - {max(ratios):.2f}",
        )
    console = Console(width=100)
    console.print(machine(), markup=False)
    console.print(table)


def glove(count: int) -> Model:
    """Return a model of equal fingers beside one another; of none, one finger by itself."""
    if not count:
        return flexor.load("glove-finger")
    parts = [
        f'[parts.f{i}]\nfile = "glove-finger"\nplacement = {{ y = "{3 * i} cm" }}'
        for i in range(count)
    ]
    loads = ", ".join(f'"f{i}.chamber" = "0:60:12 kPa"' for i in range(count))
    return Model(
        parse("\n".join(['name = "glove"', *parts, f"[evaluation]\nloads = {{ {loads} }}"]))
    )


def in_space(model: Model) -> None:
    """Let the parts of a model be followed in space."""
    assert isinstance(model.followed, Separate)
    for each in model.followed.components:
        each.__dict__["plane"] = None


def as_one(model: Model) -> None:
    """Let a model be followed as one system."""
    model.__dict__["followed"] = model.engine


def work(
    count: int, designs: int, change: Callable[[Model], None] | None = None
) -> Callable[[], object]:
    """Return the evaluation of random designs of so many fingers."""
    model = glove(count)
    if change is not None:
        change(model)
    prefixes = [f"f{i}." for i in range(count)] or [""]
    bounds = {f"{prefix}{field}": ends for prefix in prefixes for field, ends in FIELDS.items()}
    chosen = flexor.design.variables(bounds, model)
    random = np.random.default_rng(1)
    drawn = random.uniform(size=(designs, len(FIELDS) * max(FINGERS)))[:, : chosen.size]
    geometry, _ = chosen.designs(chosen.lower + drawn * (chosen.upper - chosen.lower), model)
    assert isinstance(geometry, SlotValues)
    return lambda: model.evaluate(geometry, threads=1)


if __name__ == "__main__":
    main()
