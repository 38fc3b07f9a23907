"""Physical quantities given as text with a unit, converted to SI.

All other code uses plain SI numbers. The conversion uses decimal arithmetic, so that ``"1.16 cm"``
is exactly ``0.0116``.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal
from difflib import get_close_matches
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from flexor.model import common_units
from flexor.model.validation import describe, field_error

if TYPE_CHECKING:
    from pint import UnitRegistry

_NUMBER = re.compile(
    r"\s*(?P<number>[+-]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|(?:nan|inf(?:inity)?)\b))"
    r"\s*(?P<unit>.*?)\s*",
    re.IGNORECASE,
)
_EXACT = Context(prec=50, Emax=MAX_EMAX, Emin=MIN_EMIN, traps=[])
_COMMON = (
    *("m", "cm", "mm", "um", "Pa", "kPa", "MPa", "GPa", "N", "mN", "kN", "deg", "rad"),
    *("N/m", "N/mm", "N*m", "N*mm", "N*m/rad", "N*m/deg", "g/cm^3", "kg/m^3", "m/s^2", "1/m"),
)


class Quantity(float):
    """An SI number that keeps its original text, so that a model file is written unchanged."""

    __slots__ = ("text",)
    text: str

    def __new__(cls, value: float, text: str) -> Quantity:
        """Create the number and attach its text."""
        quantity = super().__new__(cls, value)
        quantity.text = text
        return quantity

    def __getnewargs__(self) -> tuple[float, str]:  # type: ignore[override]
        return (float(self), self.text)


_SHOWN = {
    "Pa": (1e3, "kPa"),
    "m^3": (1e-6, "mL"),
    "m": (1e-3, "mm"),
    "rad": (math.pi / 180.0, "deg"),
}


@dataclass(frozen=True)
class Dimension:
    """A physical dimension."""

    name: str  # with an article, for messages
    unit: str  # SI
    example: str

    @property
    def hint(self) -> str:
        """Expected input, for the end of an error message."""
        if not self.unit:
            return f"write {self.name}, such as {self.example}"
        return f'write {self.name} with its unit, such as "{self.example}"'

    @property
    def shown(self) -> tuple[float, str]:
        """The unit in which loads are shown, in SI and by name."""
        return _SHOWN.get(self.unit, (1.0, self.unit))

    def si(self, value: float) -> Quantity:
        """Return the quantity of this dimension with this SI value."""
        return Quantity(value, f"{repr(value).removesuffix('.0')} {self.unit}")

    @property
    def noun(self) -> str:
        """Its name without the article, for headings."""
        return self.name.split(" ", 1)[1]

    @property
    def in_unit(self) -> str:
        """Its unit, for numbers that are given without one."""
        return f" in {self.unit}" if self.unit else ""

    def parse(self, value: object) -> Quantity:
        """Parse a quantity."""
        if isinstance(value, Quantity):
            value = value.text
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            if not self.unit and math.isfinite(value):
                return Quantity(value, repr(value))
            raise field_error(f"is {describe(value)}, a number without a unit: {self.hint}")
        match = _NUMBER.fullmatch(value) if isinstance(value, str) else None
        if match is None:
            raise field_error(f"is {describe(value)}, which is not {self.name}: {self.hint}")
        assert isinstance(value, str)
        if self.unit and not match["unit"]:
            raise field_error(f"is {describe(value)}, a number without a unit: {self.hint}")
        factor = self._factor(value, match["unit"])
        number = float(_EXACT.multiply(_EXACT.create_decimal(match["number"]), factor))
        if not math.isfinite(number):
            raise field_error(f"is {describe(value)}: it must be a finite number")
        return Quantity(number, " ".join(value.split()))

    def _factor(self, value: str, unit: str) -> Decimal:
        factor = _factor(unit, self.unit)
        if isinstance(factor, Decimal):
            return factor
        near = [common for common in _COMMON if _joined(common) == _joined(unit)]
        if factor == "unknown":
            why = f" with the unknown unit {describe(unit)}"
            near += get_close_matches(unit[:60], _COMMON, n=1)
        else:
            why = f", which is not {self.name}"
            near = [c for c in near if c != unit and isinstance(_factor(c, self.unit), Decimal)]
        suggestion = f' (did you mean "{near[0]}"?)' if near else ""
        raise field_error(f"is {describe(value)}{why}{suggestion}: {self.hint}")


def _joined(unit: str) -> str:
    """Return a unit without the signs of a product, as it is often written: ``Nm/rad``."""
    return "".join(sign for sign in unit.lower() if sign not in "*·. ")


@cache
def _registry() -> UnitRegistry[Any]:
    # Deferred: importing pint and reading its definitions takes a third of a second.
    from pint import UnitRegistry

    return UnitRegistry(non_int_type=Decimal)


@cache
def _factor(unit: str, si: str) -> Decimal | Literal["unknown", "other"]:
    common = common_units.factor(unit, si)
    if common is not None:
        return common
    from pint import DimensionalityError

    try:
        registry = _registry()
        factor = registry.Quantity(Decimal(1), registry.parse_units(unit)).to(si).magnitude
    except DimensionalityError:
        return "other"
    except Exception:  # pint's parser raises all kinds, including AssertionError
        return "unknown"
    return Decimal(factor)


@dataclass(frozen=True)
class QuantityField:
    """Pydantic annotation: a float parsed from text with a unit, restricted in sign."""

    dimension: Dimension
    sign: Literal["any", "non-negative", "positive"] = "any"

    @property
    def hint(self) -> str:
        """Expected input, for the end of an error message."""
        return self.dimension.hint

    def read(self, value: object) -> Quantity:
        """Parse and check a quantity; see `Dimension.parse`."""
        quantity = self.dimension.parse(value)
        if self.sign == "positive" and not quantity > 0.0:
            raise field_error(f"is {describe(quantity.text)}: it must be greater than zero")
        if (
            self.sign == "positive" and not 1e-60 <= quantity <= 1e60
        ):  # its fourth power is a normal number
            within = f"between 1e-60 and 1e60 {self.dimension.unit}"
            raise field_error(f"is {describe(quantity.text)}: it must be {within}")
        if self.sign == "non-negative" and quantity < 0.0:
            raise field_error(f"is {describe(quantity.text)}: it must not be negative")
        return quantity

    def __get_pydantic_core_schema__(
        self, source: type[Any], handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Validate with `read`; serialise as the original text."""
        return core_schema.no_info_plain_validator_function(
            self.read,
            serialization=core_schema.plain_serializer_function_ser_schema(lambda q: q.text),
        )


LENGTH = Dimension("a length", "m", "10 cm")
ANGLE = Dimension("an angle", "rad", "90 deg")
CURVATURE = Dimension("a curvature", "1/m", "2 1/m")
MODULUS = Dimension("an elastic modulus", "Pa", "30 kPa")
STIFFNESS = Dimension("a stiffness", "N/m", "100 N/m")
STIFFNESS_PER_LENGTH = Dimension("a stiffness per length", "N/m^2", "20 N/cm^2")
ANGULAR_STIFFNESS = Dimension("a joint stiffness", "N*m/rad", "0.04 N*m/rad")
FORCE = Dimension("a force", "N", "5 N")
ACTIVATION = Dimension("an activation", "", "0.3")
LOAD_FACTOR = Dimension("a load factor", "", "5")
MOMENT = Dimension("a moment", "N*m", "0.1 N*m")
PRESSURE = Dimension("a pressure", "Pa", "60 kPa")
VOLUME = Dimension("a volume", "m^3", "8 mL")
LENGTHENING = Dimension("a lengthening", "m", "10 mm")
ROTATION = Dimension("a rotation", "rad", "90 deg")
DISPLACEMENT = Dimension("a displacement", "m", "10 mm")
SHORTENING = Dimension("a shortening", "m", "10 mm")
AXIAL_STIFFNESS = Dimension("an axial stiffness", "N", "40 N")
COUPLED_STIFFNESS = Dimension("a coupling of bending and extension", "N*m", "0.1 N*m")
BENDING_STIFFNESS = Dimension("a bending stiffness", "N*m^2", "5e-4 N*m^2")
LINE_DENSITY = Dimension("a mass per length", "kg/m", "0.2 kg/m")
DENSITY = Dimension("a density", "kg/m^3", "1 g/cm^3")
ACCELERATION = Dimension("an acceleration", "m/s^2", "-9.81 m/s^2")

Length = Annotated[float, QuantityField(LENGTH)]
NonNegativeLength = Annotated[float, QuantityField(LENGTH, "non-negative")]
PositiveLength = Annotated[float, QuantityField(LENGTH, "positive")]
Angle = Annotated[float, QuantityField(ANGLE)]
PositiveAngle = Annotated[float, QuantityField(ANGLE, "positive")]
Curvature = Annotated[float, QuantityField(CURVATURE)]
Modulus = Annotated[float, QuantityField(MODULUS)]
PositivePressure = Annotated[float, QuantityField(PRESSURE, "positive")]
AxialStiffness = Annotated[float, QuantityField(AXIAL_STIFFNESS, "positive")]
CoupledStiffness = Annotated[float, QuantityField(COUPLED_STIFFNESS)]
BendingStiffness = Annotated[float, QuantityField(BENDING_STIFFNESS)]
LineDensity = Annotated[float, QuantityField(LINE_DENSITY, "non-negative")]
PositiveModulus = Annotated[float, QuantityField(MODULUS, "positive")]
Stiffness = Annotated[float, QuantityField(STIFFNESS, "non-negative")]
PositiveStiffness = Annotated[float, QuantityField(STIFFNESS, "positive")]
PositiveStiffnessPerLength = Annotated[float, QuantityField(STIFFNESS_PER_LENGTH, "positive")]
AngularStiffness = Annotated[float, QuantityField(ANGULAR_STIFFNESS, "non-negative")]
PositiveAngularStiffness = Annotated[float, QuantityField(ANGULAR_STIFFNESS, "positive")]
Force = Annotated[float, QuantityField(FORCE)]
NonNegativeForce = Annotated[float, QuantityField(FORCE, "non-negative")]
PositiveForce = Annotated[float, QuantityField(FORCE, "positive")]
Moment = Annotated[float, QuantityField(MOMENT)]
NonNegativeMoment = Annotated[float, QuantityField(MOMENT, "non-negative")]
Density = Annotated[float, QuantityField(DENSITY, "non-negative")]
Acceleration = Annotated[float, QuantityField(ACCELERATION)]
