"""Parsing of starting designs and bounds that are given as texts."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from flexor.errors import InputError, unknown
from flexor.model.validation import describe

if TYPE_CHECKING:
    from flexor.design import ParameterSet

_VALUE = re.compile(r"(?P<number>[^a-zA-Z]*(?:[eE][+-]?\d+)?)\s*(?P<unit>[a-zA-Z]*)")
_COMPATIBLE = ({"m", "cm", "mm"}, {"rad", "deg"}, {"1"})


def starts(
    texts: Sequence[str], chosen: ParameterSet, option: str = "--start"
) -> list[list[float]] | str | None:
    """Parse starting designs: designs in SI units, `"random"`, or None if no start is given.

    Each text is `random`, values in the order of the parameters such as `10 cm, 0.7 cm`, or
    `label=value` pairs such as `R_0=0.7 cm`, with the other parameters at the set's default.
    Messages begin with ``option``.
    """
    if not texts:
        return None
    if len(texts) == 1 and texts[0].strip().lower() == "random":
        return "random"
    return [_design(text, chosen, option) for text in texts]


def bounds_in_si(
    bounds: Mapping[str, Sequence[object]], chosen: ParameterSet
) -> dict[str, tuple[float, float]]:
    """Convert bounds by label, numbers in SI units or texts such as ``"6 cm"``."""
    converted = {}
    if not isinstance(bounds, Mapping):
        raise InputError(
            f"bounds is {describe(bounds)}: it must be a mapping of parameters to pairs, such as "
            f'{{"{chosen.labels[0]}": (lower, upper)}}.'
        )
    for label, pair in bounds.items():
        if label not in chosen.labels:
            raise unknown(f"parameter of {chosen.name}", label, chosen.labels)
        if isinstance(pair, str) or not isinstance(pair, Sequence | np.ndarray) or len(pair) != 2:
            raise InputError(f"bounds has {label} = {pair!r}: expected a lower and an upper bound.")
        low, high = (
            chosen.parse(label, end, "bounds") if isinstance(end, str) else _number(end, label)
            for end in pair
        )
        converted[label] = (low, high)
    return converted


def _number(value: object, label: str) -> float:
    if isinstance(value, (int, float, np.number)) and not isinstance(value, bool):
        try:
            return float(value)
        except OverflowError:
            raise InputError(f"bounds has {label}: a number is too large.") from None
    raise InputError(f"bounds has {label} = {value!r}: expected a number or a text with its unit.")


def _design(text: str, chosen: ParameterSet, option: str) -> list[float]:
    parts = [part.strip() for part in text.split(",") if part.strip()]
    labels = chosen.labels
    if parts and all("=" in part for part in parts):
        design = [float(value) for value in chosen.start]
        for part in parts:
            label, _, value = (side.strip() for side in part.partition("="))
            if label not in labels:
                raise unknown(f"parameter of {chosen.name}", label, labels)
            design[labels.index(label)] = chosen.parse(label, value, option)
        return design
    if len(parts) != len(labels):
        raise InputError(
            f'{option} is "{text}": {chosen.name} needs {len(labels)} values '
            f'({", ".join(labels)}), label=value pairs, or "random".'
        )
    return [chosen.parse(label, part, option) for part, label in zip(parts, labels, strict=True)]


def parse_value(text: str, label: str, own: str, option: str) -> float:
    """Read the value of a parameter with a unit of `UNITS`, SI; see `ParameterSet.parse`."""
    from flexor.design.parameter_set import UNITS

    match = _VALUE.fullmatch(text)
    unit = (match["unit"] if match else "") or ("1" if own == "1" else "")
    allowed = next(units for units in _COMPATIBLE if own in units)
    try:
        number = float(match["number"]) if match else math.nan
    except ValueError:
        number = math.nan
    if unit not in allowed or not math.isfinite(number):
        units = ", ".join(unit for unit in UNITS if unit in allowed)
        units = "" if own == "1" else f" with its unit: {units}"
        raise InputError(f'{option} has {label} = "{text}": expected a finite number{units}.')
    return number * UNITS[unit]
