"""Values with units of a known kind, or of the kind that follows from the unit."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from decimal import Decimal

from pydantic_core import PydanticCustomError

from flexor.errors import InputError
from flexor.model import units
from flexor.model.units import Dimension
from flexor.model.validation import describe

# In this order: N*m/rad and N*m are one dimension.
_KINDS = (
    *(units.LENGTH, units.ANGLE, units.MODULUS, units.STIFFNESS, units.ANGULAR_STIFFNESS),
    *(units.FORCE, units.DENSITY, units.CURVATURE, units.ACCELERATION, units.VOLUME),
    *(units.MOMENT, units.BENDING_STIFFNESS, units.LINE_DENSITY),
)
_MOST_DIGITS = 20
_UNIT = re.compile(r"\s*[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?\s*(?P<unit>.*?)\s*")


@dataclass(frozen=True)
class Unit:
    """The unit in which a value was written; empty for plain numbers."""

    text: str = ""  # as written, such as "MPa"
    factor: float = 1.0  # its SI value
    si: str = ""  # the SI unit of its kind

    def shown(self, value: float, digits: int = 5) -> str:
        """Return an SI value in this unit, with so many significant digits."""
        number = f"{value / self.factor:.{digits}g}"
        number = "0" if float(number) == 0.0 else number
        return f"{number} {self.text}".rstrip()

    def exact(self, value: float) -> str | float:
        """Return an SI value for a model file, with all digits."""
        return f"{value!r} {self.si}" if self.si else value

    def digits(self, value: float) -> str | float:
        """Return an SI value in this unit for a model file, with as many digits as it has."""
        size = Decimal(value) / Decimal(self.factor)
        plain = self.si and 1e-6 <= abs(size) < 1e12
        for count in range(1, _MOST_DIGITS if plain else 0):
            text = f"{Decimal(f'{size:.{count}g}'):f} {self.text}"
            if infer_quantity(text, "value")[0] == value:
                return text
        return self.exact(value)


def parse_quantity(value: object, kind: Dimension | None, place: str) -> tuple[float, Unit]:
    """Return the SI value and the unit of a quantity of a known kind, such as ``"10 cm"``.

    Plain numbers where `kind` is None; messages begin with `place`.
    """
    if kind is None:
        if not isinstance(value, (int, float)) or isinstance(value, bool):
            raise InputError(f"{place} is {describe(value)}: expected a plain number.")
        if not math.isfinite(value):
            raise InputError(f"{place} is {float(value)!r}: it must be a finite number.")
        return float(value), Unit()
    try:
        number = kind.parse(value)
        match = _UNIT.fullmatch(number.text)
        text = match["unit"] if match else ""
        return float(number), Unit(text, float(kind.parse(f"1 {text}")), kind.unit)
    except PydanticCustomError as error:
        raise InputError(f"{place} {error.message()}.") from None


def infer_quantity(value: object, place: str) -> tuple[float, Unit]:
    """Read a value whose kind follows from its unit; see `parse_quantity`."""
    if not isinstance(value, str):
        return parse_quantity(value, None, place)
    for kind in _KINDS:
        try:
            kind.parse(value)
        except PydanticCustomError:
            continue
        return parse_quantity(value, kind, place)
    example = 'such as "30 kPa", or a plain number for what has none'
    raise InputError(f"{place} is {describe(value)}: write a value with its unit, {example}.")
