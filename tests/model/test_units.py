"""Quantities with units."""

from __future__ import annotations

import copy
import math
import pickle
from collections import defaultdict
from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pint import UnitRegistry
from pydantic import TypeAdapter, ValidationError

from flexor.model import units
from flexor.model.common_units import factor


@pytest.mark.parametrize(
    ("dimension", "text", "value"),
    [
        (units.LENGTH, "10 cm", 0.1),
        (units.LENGTH, "1.16cm", 0.0116),
        (units.LENGTH, " 2e-3   m ", 0.002),
        (units.LENGTH, "-1 in", -0.0254),
        (units.LENGTH, "12 µm", 12e-6),
        (units.MODULUS, "30 kPa", 30_000.0),
        (units.MODULUS, "2.2285 MPa", 2_228_500.0),
        (units.MODULUS, "1 N/mm^2", 1e6),
        (units.STIFFNESS, "77.1 N/m", 77.1),
        (units.ANGULAR_STIFFNESS, "0.04 N*m/rad", 0.04),
        (units.ANGULAR_STIFFNESS, "0.04 N·m/rad", 0.04),
        (units.ANGULAR_STIFFNESS, "1 N*m/deg", 180.0 / math.pi),
        (units.ANGLE, "90 deg", math.pi / 2.0),
        (units.ANGLE, "-10°", -math.pi / 18.0),
        (units.CURVATURE, "2 1/m", 2.0),
        (units.CURVATURE, "1 deg/cm", math.pi / 1.8),
        (units.FORCE, "5 N", 5.0),
        (units.FORCE, "500 mN", 0.5),
        (units.MOMENT, "3 N*mm", 0.003),
        (units.DENSITY, "1 g/cm^3", 1000.0),
        (units.ACCELERATION, "-9.81 m/s^2", -9.81),
    ],
)
def test_text_becomes_si(dimension: units.Dimension, text: str, value: float) -> None:
    assert dimension.parse(text) == value


@given(st.decimals(-1000, 1000, places=6))
def test_conversion_rounds_only_once(number: object) -> None:
    """Centimetres are the exact decimal hundredth, rounded to the nearest double."""
    from decimal import Decimal

    assert isinstance(number, Decimal)
    assert units.LENGTH.parse(f"{number} cm") == float(number / 100)


def test_quantity_keeps_its_text() -> None:
    quantity = units.LENGTH.parse("10  cm")
    for same in (quantity, copy.deepcopy(quantity), pickle.loads(pickle.dumps(quantity))):
        assert same == 0.1
        assert same.text == "10 cm"
    assert units.LENGTH.parse(quantity) == quantity
    assert units.LENGTH.si(0.25).text == "0.25 m"
    assert units.LENGTH.parse(units.LENGTH.si(1e-7)) == 1e-7


WRITE = 'write a length with its unit, such as "10 cm"'


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (10, f"is 10, a number without a unit: {WRITE}"),
        (0.1, f"is 0.1, a number without a unit: {WRITE}"),
        ("10", f'is "10", a number without a unit: {WRITE}'),
        ("30 kg", f'is "30 kg", which is not a length: {WRITE}'),
        ("30 cm^2", f'is "30 cm^2", which is not a length: {WRITE}'),
        ("10 %", f'is "10 %", which is not a length: {WRITE}'),
        ("10 Cm", f'is "10 Cm" with the unknown unit "Cm" (did you mean "cm"?): {WRITE}'),
        ("3 2 m", f'is "3 2 m" with the unknown unit "2 m": {WRITE}'),
        ("ten cm", f'is "ten cm", which is not a length: {WRITE}'),
        ("3 cm + 4 mm", f'is "3 cm + 4 mm" with the unknown unit "cm + 4 mm": {WRITE}'),
        ("10 cm; 3", f'is "10 cm; 3" with the unknown unit "cm; 3": {WRITE}'),
        ("", f'is "", which is not a length: {WRITE}'),
        (True, f"is true, which is not a length: {WRITE}"),
        ([], f"is a list, which is not a length: {WRITE}"),
        ("nan cm", 'is "nan cm": it must be a finite number'),
        ("-inf cm", 'is "-inf cm": it must be a finite number'),
        ("1e999 cm", 'is "1e999 cm": it must be a finite number'),
        ("1e999999999 km", 'is "1e999999999 km": it must be a finite number'),
        ("0 cm", 'is "0 cm": it must be greater than zero'),
        ("-1 cm", 'is "-1 cm": it must be greater than zero'),
    ],
)
def test_bad_length(value: object, message: str) -> None:
    with pytest.raises(ValidationError) as caught:
        TypeAdapter(units.PositiveLength).validate_python(value)
    assert caught.value.errors()[0]["msg"] == message


def test_zero_and_negative_values_where_allowed() -> None:
    assert TypeAdapter(units.Stiffness).validate_python("0 N/m") == 0.0
    assert TypeAdapter(units.Length).validate_python("-1 cm") == -0.01
    with pytest.raises(ValidationError, match="it must not be negative"):
        TypeAdapter(units.Stiffness).validate_python("-1 N/m")


@given(st.text(max_size=20))
def test_any_text_is_parsed_or_rejected_with_a_message(text: str) -> None:
    try:
        value = TypeAdapter(units.PositiveLength).validate_python(text)
    except ValidationError as error:
        assert error.errors()[0]["msg"].startswith("is ")
    else:
        assert 0.0 < value < math.inf


def test_usual_units_are_those_of_pint() -> None:
    """Every pair of products of two of them, to all digits of a float, or neither."""
    registry = UnitRegistry(non_int_type=Decimal)
    names = ["m", "cm^2", "mm", "um", "L", "mL", "g", "kg", "s^2", "N", "mN", "kPa", "GPa", "rad"]
    texts = [
        *names,
        "deg",
        "1/m",
        *(f"{a}{sign}{b}" for a in names for b in names for sign in "*/"),
    ]
    by_kind = defaultdict(list)
    for text in texts:
        unit = registry.parse_units(text)
        by_kind[str(registry.Quantity(Decimal(1), unit).dimensionality)].append((text, unit))
    for alike in by_kind.values():
        si = str(alike[0][0])
        for text, unit in alike:
            expected = registry.Quantity(Decimal(1), unit).to(si).magnitude
            found = factor(text, si)
            assert isinstance(found, Decimal) and float(found) == float(expected), (text, si)
    assert factor("N", "m") == "other"
    for unknown in ("inch", "N m", "", "m^0.5", "m//s", "*m", "2m", "N/(m*s)"):
        assert factor(unknown, "m") is None
