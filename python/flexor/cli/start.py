"""Parsing of starting designs."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from flexor.errors import InputError, unknown

if TYPE_CHECKING:
    from flexor.design import ParameterSet

_VALUE = re.compile(r"(?P<number>[^a-zA-Z]*(?:[eE][+-]?\d+)?)\s*(?P<unit>[a-zA-Z]*)")
_COMPATIBLE = ({"m", "cm", "mm"}, {"rad", "deg"}, {"1"})


def starts(texts: list[str], chosen: ParameterSet) -> list[list[float]] | str | None:
    """Parse the values of `--start`.

    Parameters
    ----------
    texts : list of str
        Each is `random`, values in the order of the parameters such as `10 cm, 0.7 cm`, or
        `label=value` pairs such as `R_0=0.7 cm`, with the other parameters at the set's default.
        Numbers without a unit are in the set's display units.
    chosen : ParameterSet
        The parameter set.

    Returns
    -------
    list of lists of float, str or None
        Designs in SI units; `"random"`; or None if no start is given.

    Raises
    ------
    InputError
        If a design is invalid.
    """
    if not texts:
        return None
    if len(texts) == 1 and texts[0].strip().lower() == "random":
        return "random"
    return [_design(text, chosen) for text in texts]


def _design(text: str, chosen: ParameterSet) -> list[float]:
    parts = [part.strip() for part in text.split(",") if part.strip()]
    labels = chosen.labels
    if parts and all("=" in part for part in parts):
        design = [float(value) for value in chosen.start]
        for part in parts:
            label, _, value = (side.strip() for side in part.partition("="))
            if label not in labels:
                raise unknown(f"parameter of {chosen.name}", label, labels)
            design[labels.index(label)] = _si(value, label, chosen)
        return design
    if len(parts) != len(labels):
        raise InputError(
            f'--start is "{text}": {chosen.name} needs {len(labels)} values '
            f'({", ".join(labels)}), label=value pairs, or "random".'
        )
    return [_si(part, label, chosen) for part, label in zip(parts, labels, strict=True)]


def _si(text: str, label: str, chosen: ParameterSet) -> float:
    from flexor.design.parameter_set import UNITS

    own = chosen.units[chosen.labels.index(label)]
    match = _VALUE.fullmatch(text)
    unit = (match["unit"] if match else "") or own
    allowed = next(units for units in _COMPATIBLE if own in units)
    try:
        number = float(match["number"]) if match else math.nan
    except ValueError:
        number = math.nan
    if unit not in allowed or not math.isfinite(number):
        units = "" if own == "1" else f" in {', '.join(u for u in UNITS if u in allowed)}"
        raise InputError(f'--start has {label} = "{text}": expected a finite number{units}.')
    return number * UNITS[unit]
