"""Files of a printed finger: its parts, its springs, and a table for bench measurements."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from flexor.errors import InputError
from flexor.export.bench import template
from flexor.export.files import write_solid, write_text
from flexor.export.finger import Finger
from flexor.export.springs import Spring
from flexor.store.files import csv_text, reason

if TYPE_CHECKING:
    from flexor.model import Model

HEADINGS = (
    *("joint", "k / N mm/rad", "wire / mm", "coil / mm", "turns", "length / mm"),
    *("moment / N mm", "stress / MPa"),
)


def spring_row(spring: Spring) -> tuple[str, ...]:
    """Return the cells of a spring under `HEADINGS`."""
    return (
        spring.joint,
        f"{1e3 * spring.stiffness:.4g}",
        f"{1e3 * spring.wire:.3g}",
        f"{1e3 * spring.diameter:.3g}",
        f"{spring.turns:.2f}",
        f"{1e3 * spring.body:.2f}",
        f"{1e3 * spring.moment:.3g}",
        f"{1e-6 * spring.stress:.4g}",
    )


def write_finger(made: Finger, model: Model, target: Path) -> list[Path]:
    """Write a finger: into one file, by the ending of its name, or into a folder.

    A folder takes each part, `springs.csv`, and `bench.csv` to fill in.
    """
    if target.suffix:
        write_solid(made.laid_out(), target)
        return [target]
    try:
        target.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f'"{target}" cannot be made: {reason(error)}.') from None
    files = []
    for name, solid in made.parts.items():
        files.append(target / f"{name}.stl")
        write_solid(solid, files[-1])
    tables = {"springs.csv": csv_text([HEADINGS, *map(spring_row, made.springs)])}
    tables["bench.csv"] = template(model)
    for name, text in tables.items():
        files.append(target / name)
        write_text(files[-1], text)
    return files
