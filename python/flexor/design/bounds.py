"""Bounds of design variables, as texts with units or numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from flexor.design.fields import refusal
from flexor.errors import InputError
from flexor.model.quantity import Unit, infer_quantity

if TYPE_CHECKING:
    from flexor.model.schema import ModelFile


def read_bounds(
    pair: Sequence[object], label: str, own: Unit, with_unit: bool, source: str
) -> tuple[tuple[float, float], Unit]:
    """Read the bounds of a field.

    Parameters
    ----------
    pair
        The lower and the upper one.
    label
        The field, for messages.
    own
        Its unit.
    with_unit
        Whether numbers are texts with their unit.
    source
        Where the bounds are from, for messages.

    Returns
    -------
    pair of float, Unit
        The bounds, SI, and the unit in which the field is shown.
    """
    if isinstance(pair, str) or len(pair) != 2:
        raise InputError(f"{source}: {label} = {pair!r}: expected a lower and an upper bound.")
    found = []
    for end in pair:
        stated = f'{source}: {label} has the bound "{end}"'
        if not _is_finite(end):
            raise InputError(f"{stated}: it must be a finite number.")
        value = number_of(end) if not with_unit and isinstance(end, str) else end
        try:
            number, unit = infer_quantity(value, f"{source}: {label}")
        except InputError:
            number, unit = 0.0, None
        if unit is None or unit.si != own.si:
            raise InputError(f"{stated}: expected {wanted(own)}.")
        found.append((number, unit))
    (low, _), (high, shown) = found
    if not low < high:
        given = ":".join(map(str, pair))
        raise InputError(
            f"{source}: {label} = {given}: the lower bound must be below the upper one."
        )
    return (low, high), shown


def check_bounds(
    pair: Sequence[object],
    ends: tuple[float, float],
    own: Unit,
    label: str,
    keys: tuple[str, ...],
    file: ModelFile,
    source: str,
) -> None:
    """Check that both bounds, as they were given and SI, are values that a field may have."""
    for stated, value in zip(pair, ends, strict=True):
        why = refusal(keys, own.exact(value), file)
        if why:
            raise InputError(f'{source}: {label} has the bound "{stated}": {why}.')


def check_fractions(label: str, ends: tuple[float, float], source: str) -> None:
    """Check the bounds of a place along a rod, a fraction of its length."""
    if not 0.0 <= ends[0] < ends[1] <= 1.0:
        raise InputError(
            f"{source}: {label} = {ends[0]:g}:{ends[1]:g}: the bounds of a place along a rod are "
            "from 0 to 1."
        )


def wanted(own: Unit) -> str:
    """Say what a value of a field is, by its unit."""
    return f"a value with its unit, such as 10 {own.text}" if own.si else "a plain number"


def number_of(text: str) -> object:
    """Return the number that a text is, or the text."""
    try:
        return float(text)
    except ValueError:
        return text


def _is_finite(end: object) -> bool:
    """Whether a bound, with its unit or not, is neither infinite nor NaN."""
    number = number_of(str(end).partition(" ")[0])
    return not isinstance(number, float) or math.isfinite(number)
