"""Constants to be fitted, and the fields of the models that they set."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexor.arrays import Array
from flexor.calibration.schema import Constant as Table
from flexor.errors import InputError, unknown_name
from flexor.model import ModelFile
from flexor.model.changes import with_whole_name
from flexor.model.quantity import Unit, infer_quantity

_NAMED = tuple(ModelFile.named_tables())


@dataclass(frozen=True)
class Constant:
    """A constant with its range."""

    name: str  # what it is called in tables
    fields: tuple[str, ...]  # dotted fields of model files that it sets
    low: float  # of the range, SI
    high: float  # of the range, SI
    log: bool  # whether equal steps of the search are equal factors
    unit: Unit  # the unit for display

    @classmethod
    def of(cls, table: Table, source: str) -> Constant:
        """Read a ``[[constant]]``; InputError if the ends of its range have different units."""
        place = f'{source}: constant "{table.name}"'
        high, unit = infer_quantity(table.range[1], f"{place}.range[1]")
        low, other = infer_quantity(table.range[0], f"{place}.range[0]")
        listed = f'["{table.range[0]}", "{table.range[1]}"]' if unit.si else f"{list(table.range)}"
        if other.si != unit.si:
            raise InputError(f"{place}.range is {listed}: both must be of one kind.")
        if not low < high:
            raise InputError(
                f"{place}.range is {listed}: the lower end must be below the upper one."
            )
        if table.scale == "log" and low <= 0.0:
            raise InputError(
                f"{place}.range is {listed}: on a log scale it must be above zero; "
                'write scale = "linear".'
            )
        return cls(table.name, table.fields, low, high, table.scale == "log", unit)

    def value(self, u: Array) -> Array:
        """Return SI values at fractions u of the range, in its scale; any shape."""
        if self.log:
            ratio = math.log(self.high / self.low)
            return np.clip(self.low * np.exp(ratio * u), self.low, self.high)
        return np.clip(self.low + (self.high - self.low) * u, self.low, self.high)

    def fraction(self, value: float) -> float:
        """Return where in the range an SI value is, in its scale."""
        if self.log:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def shown(self, value: float, digits: int = 5) -> str:
        """Return a value in the unit for display."""
        return self.unit.shown(value, digits)


def check_fields(
    constants: Sequence[Constant], files: Mapping[str, ModelFile], source: str
) -> None:
    """Demand that every field is a field of at least one of the models, once."""
    owner: dict[str, str] = {}
    for constant in constants:
        for field in constant.fields:
            place = f'{source}: constant "{constant.name}".fields has "{field}"'
            paths = {full(field, file) for file in files.values()} - {None}
            if not paths:
                raise InputError(f"{place}: {_absent(field, files)}.")
            for path in paths:
                assert path is not None
                if path in owner:
                    raise InputError(f'{place}, which the constant "{owner[path]}" sets already.')
                owner[path] = constant.name


def full(field: str, file: ModelFile) -> str | None:
    """Return a dotted field with its table in front, or None if the model has no such table.

    ``"exosuit.length"`` becomes ``"bodies.exosuit.length"``.
    """
    keys = field.split(".")
    if keys[0] not in ModelFile.model_fields:
        names = [name for table in _NAMED for name in getattr(file, table)]
        keys = with_whole_name(keys, names)
        table = next((t for t in _NAMED if keys[0] in getattr(file, t)), None)
        return None if table is None else f"{table}.{field}"
    things: Any = getattr(file, keys[0])
    if keys[0] in _NAMED:
        keys = [keys[0], *with_whole_name(keys[1:], things)]
        return field if len(keys) > 1 and keys[1] in things else None
    return field


def _absent(field: str, files: Mapping[str, ModelFile]) -> str:
    keys = field.split(".")
    tables = [keys[0]] if keys[0] in _NAMED else list(_NAMED)
    things = dict.fromkeys(
        name for file in files.values() for table in tables for name in getattr(file, table)
    )
    named = len(files) == 1 and next(iter(files))
    which = f'the model "{named}" has' if named else "none of the models has it:"
    wanted = keys[1] if keys[0] in _NAMED and len(keys) > 1 else keys[0]
    return f"{which} {'the ' if named else ''}{unknown_name('entry', wanted, things)}"
