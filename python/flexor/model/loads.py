"""Parsing of the loads of a path."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from decimal import Decimal, InvalidOperation

import numpy as np
from pydantic_core import PydanticCustomError

from flexor.arrays import Array
from flexor.errors import InputError, unknown
from flexor.model.units import FORCE, LOAD_FACTOR, MOMENT, Dimension
from flexor.model.validation import describe

Forces = str | float | Sequence[float | str] | Array
_MAX_STEPS = 1_000_000
_BARE = (FORCE, MOMENT, LOAD_FACTOR)  # whose texts may be plain numbers


def forces(force: Forces, dimension: Dimension = FORCE, name: str = "force") -> Array:
    """Parse a list of loads: forces, unless they have another dimension.

    Parameters
    ----------
    force
        Numbers in N, texts with a unit (``"500 mN"``) and ranges ``"start:stop:step"`` such as
        ``"0:5:1"``, up or down, which end at the stop (with a smaller step if needed); or one text
        of these with commas between them. A single value is a list of one. Forces may rise, fall
        and be negative; where a range begins as the entry before it ends, that force comes once.
    dimension
        Dimension of the loads. Texts with pressures (``"0:60:5 kPa"``), volumes and lengths need a
        unit.
    name
        Their name in messages.

    Returns
    -------
    (steps,) array
        The loads [SI].

    Raises
    ------
    InputError
        If the list is empty, or an entry is not a finite force.
    """
    if isinstance(force, str):
        entries: list[tuple[str, object]] = [(name, part) for part in force.split(",")]
    elif isinstance(force, (int, float)):
        entries = [(name, force)]
    else:
        entries = [(f"{name}[{index}]", entry) for index, entry in enumerate(force)]
    values: list[float] = []
    for path, entry in entries:
        if isinstance(entry, str) and ":" in entry:
            steps = _range(entry.strip(), path, dimension)
            values += steps[1:] if values and values[-1] == steps[0] else steps
        else:
            values.append(_value(entry, path, dimension))
        if len(values) > _MAX_STEPS:
            raise InputError(f"{path} is too long: a path has at most {_MAX_STEPS:,} steps.")
    if not values:
        raise InputError(
            f"{name} is an empty list: give at least one {dimension.name.split()[-1]}, such as "
            f"{_example(dimension)}."
        )
    return np.array(values)


def loads(force: Forces | Mapping[str, Forces], inputs: Mapping[str, Dimension]) -> Array:
    """Parse the loads of all inputs of these dimensions, (steps, inputs) [SI].

    A table has forces by the name of the input: an input that is left out stays at zero, a single
    force is held constant. An array or a list of lists has all of them, in SI units.
    """
    table = None if isinstance(force, (str, Mapping)) else _table(force)
    if table is not None:
        if table.shape[1] != len(inputs) or not len(table) or not np.isfinite(table).all():
            raise InputError(
                f"force is a table of {table.shape[0]} x {table.shape[1]} numbers: expected rows "
                f"of {len(inputs)} finite ones, one for each input."
            )
        return table
    if not isinstance(force, Mapping):
        if len(inputs) == 1:
            return forces(force, next(iter(inputs.values())))[:, None]
        if not inputs:
            if not (column := forces(force)).any():
                return np.zeros((len(column), 0))
            raise InputError("force is given, but the model has no actuator: leave it out.")
        listed = ", ".join(f'"{name}"' for name in inputs)
        raise InputError(
            f"force must name its input, one of {listed}: use a dict in Python, and "
            f"{next(iter(inputs))}={_example(next(iter(inputs.values())))} on the command line."
        )
    columns = {}
    for name, values in force.items():
        if name not in inputs:
            raise unknown("input", name, inputs)
        columns[name] = forces(values, inputs[name], f"load of {name}")
    steps = max((len(column) for column in columns.values()), default=1)
    result = np.zeros((steps, len(inputs)))
    for name, column in columns.items():
        if len(column) not in (1, steps):
            raise InputError(
                f'force has {len(column)} steps for "{name}" and {steps} for another input: '
                "give the same number for each, or one to hold constant."
            )
        result[:, list(inputs).index(name)] = column
    return result


def _table(force: object) -> Array | None:
    """Return loads of several inputs that are an array or a list of lists, (steps, inputs)."""
    nested = isinstance(force, np.ndarray) or (
        isinstance(force, Sequence) and len(force) and isinstance(force[0], Sequence)
    )
    if not nested or (isinstance(force, Sequence) and isinstance(force[0], str)):
        return None
    found = np.asarray(force, dtype=float)
    return found if found.ndim == 2 else None


def _example(dimension: Dimension) -> str:
    last, _, unit = dimension.example.partition(" ")
    return "0:5:1" if dimension in _BARE else f"0:{last}:{5 if len(last) > 1 else 1} {unit}"


def _value(value: object, path: str, dimension: Dimension) -> float:
    bare = dimension in _BARE
    if bare and isinstance(value, str) and (number := _decimal(value)) is not None:
        value = float(number)
    if isinstance(value, str):
        try:
            return float(dimension.parse(value.strip()))
        except PydanticCustomError as error:
            raise InputError(f"{path} {error.message()}.") from None
    if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise InputError(
            f"{path} is {describe(value)}: expected {dimension.name}{dimension.in_unit}."
        )
    if not math.isfinite(value):
        raise InputError(f"{path} is {float(value)!r}: it must be a finite number.")
    return float(value)


def _range(text: str, path: str, dimension: Dimension) -> list[float]:
    """Parse a range whose last number has the unit of all."""
    last = re.fullmatch(r"\s*[-+]?[\d.]+(?:[eE][-+]?\d+)?\s*(.*?)\s*", text.split(":")[-1])
    unit = last[1] if last else ""
    parts = [part.strip().removesuffix(unit).strip() for part in text.split(":")]
    if not unit and dimension in _BARE:
        return [float(step) for step in _steps(parts, text, path, dimension)]
    one = f"1 {unit}".strip()
    try:
        dimension.parse(one)
    except PydanticCustomError as error:
        why = error.message().removeprefix(f"is {describe(one)}")
        raise InputError(f'{path} is "{text}"{why}.') from None
    steps = _steps(parts, text, path, dimension)
    return [float(dimension.parse(f"{step} {unit}")) for step in steps]


def _steps(parts: list[str], text: str, path: str, dimension: Dimension) -> list[Decimal]:
    numbers = [_decimal(part) for part in parts]
    if len(numbers) == 2:
        numbers.append(Decimal(1))
    finite = [n for n in numbers if n is not None and n.is_finite()]
    if len(finite) != 3 or len(numbers) != 3:
        tail = f"write start:stop:step{dimension.in_unit}, such as {_example(dimension)}"
        raise InputError(f'{path} is "{text}": {tail}.')
    start, stop, step = finite
    if step <= 0:
        raise InputError(
            f'{path} is "{text}": the step must be greater than zero, also where the load falls.'
        )
    steps = abs(stop - start) / step
    if steps >= _MAX_STEPS:
        raise InputError(f'{path} is "{text}": a path has at most {_MAX_STEPS:,} steps.')
    step = step.copy_sign(stop - start)
    # Decimal, so that 0:5:0.1 holds exactly the numbers that 0:5:1 holds.
    found = [start + step * index for index in range(int(steps) + 1)]
    return found if found[-1] == stop else [*found, stop]


def _decimal(text: str) -> Decimal | None:
    try:
        return Decimal(text)
    except InvalidOperation:
        return None
