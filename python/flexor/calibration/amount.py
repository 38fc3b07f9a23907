"""Values with units whose kind is known, or is to be seen from the unit."""

from __future__ import annotations

import re
from dataclasses import dataclass

from pydantic_core import PydanticCustomError

from flexor.errors import InputError
from flexor.model import units
from flexor.model.units import Dimension
from flexor.model.validation import describe

# In this order, because to a computer of units N*m/rad and N*m are the same.
_KINDS = (
    *(units.LENGTH, units.ANGLE, units.MODULUS, units.STIFFNESS, units.ANGULAR_STIFFNESS),
    *(units.FORCE, units.DENSITY, units.CURVATURE, units.ACCELERATION),
)
_UNIT = re.compile(r"\s*[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?\s*(?P<unit>.*?)\s*")


@dataclass(frozen=True)
class Unit:
    """A unit in which a person wrote a value; the empty unit is that of plain numbers.

    Attributes
    ----------
    text : str
        As written, such as ``"MPa"``.
    factor : float
        Its SI value.
    si : str
        The SI unit of its kind.
    """

    text: str = ""
    factor: float = 1.0
    si: str = ""

    def shown(self, value: float, digits: int = 5) -> str:
        """Return an SI value in this unit, with so many significant digits."""
        number = f"{value / self.factor:.{digits}g}"
        number = "0" if float(number) == 0.0 else number
        return f"{number} {self.text}".rstrip()

    def exactly(self, value: float) -> str | float:
        """Return an SI value as a model file may have it, with all its digits."""
        return f"{value!r} {self.si}" if self.si else value


def amount(value: object, kind: Dimension | None, place: str) -> tuple[float, Unit]:
    """Read a value of a known kind.

    Parameters
    ----------
    value
        Text such as ``"10 cm"``, or a number where the kind has no unit.
    kind
        The kind of quantity; None for plain numbers.
    place
        File and field, for messages.

    Returns
    -------
    float, Unit
        SI value, and the unit it was written in.

    Raises
    ------
    InputError
        If it has no unit, or that of something else.
    """
    if kind is None:
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return _finite(float(value), place), Unit()
        raise InputError(f"{place} is {describe(value)}: a plain number is needed.")
    try:
        number = kind.parse(value)
        text = _unit(number.text)
        return float(number), Unit(text, float(kind.parse(f"1 {text}")), kind.unit)
    except PydanticCustomError as error:
        raise InputError(f"{place} {error.message()}.") from None


def any_amount(value: object, place: str) -> tuple[float, Unit]:
    """Read a value whose kind its unit says; see `amount`."""
    if not isinstance(value, str):
        return amount(value, None, place)
    for kind in _KINDS:
        try:
            kind.parse(value)
        except PydanticCustomError:
            continue
        return amount(value, kind, place)
    example = 'such as "30 kPa", or a plain number for what has none'
    raise InputError(f"{place} is {describe(value)}: write a value with its unit, {example}.")


def _unit(text: str) -> str:
    match = _UNIT.fullmatch(text)
    return match["unit"] if match else ""


def _finite(number: float, place: str) -> float:
    if abs(number) < float("inf"):
        return number
    raise InputError(f"{place} is {number!r}: it must be a finite number.")
