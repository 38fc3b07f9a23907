"""A part of another size: lengths change, and what has no length in it does not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from flexor.model.composition.rebuilding import rebuilt
from flexor.model.quantity import infer_quantity
from flexor.model.schema.table import Table
from flexor.model.units import Quantity

# The power of the scale with which quantities of these units change.
_POWERS = {"m": 1, "1/m": -1}


def scaled(table: Table, factor: float) -> Table:
    """Return a table whose lengths are multiplied, and whose curvatures are divided, by a factor.

    Everything else is as it was: materials and their moduli, densities, the stiffness of joints,
    straps, springs and contacts, stiffnesses of sections that are given as numbers, and forces.
    """

    def change(each: Table) -> Mapping[str, Any]:
        found = {name: getattr(each, name) for name in type(each).model_fields}
        made = {name: _scaled(value, factor) for name, value in found.items()}
        return {name: value for name, value in made.items() if value is not found[name]}

    made: Table = rebuilt(table, change)
    return made


def _scaled(value: Any, factor: float) -> Any:
    if isinstance(value, tuple):
        items = tuple(_scaled(each, factor) for each in value)
        return value if all(new is old for new, old in zip(items, value, strict=True)) else items
    if not isinstance(value, Quantity) or value == 0.0:
        return value
    unit = infer_quantity(value.text, "value")[1].si
    if unit not in _POWERS:
        return value
    size = float(value) * factor ** _POWERS[unit]
    return Quantity(size, f"{size!r} {unit}")
