"""Factors of the usual units, without the half second that it takes to import pint."""

from __future__ import annotations

import re
from collections.abc import Mapping
from decimal import Context, Decimal
from typing import Literal

# In SI, and the exponents of m, kg and s; a radian is a plain number.
_PI = Decimal("3.1415926535897932384626433832795028841971693993751")
_UNITS: Mapping[str, tuple[Decimal, tuple[int, int, int]]] = {
    **{name: (Decimal(size), (1, 0, 0)) for name, size in
       (("m", "1"), ("cm", "1e-2"), ("mm", "1e-3"), ("um", "1e-6"))},
    **{name: (Decimal(size), (3, 0, 0)) for name, size in (("L", "1e-3"), ("mL", "1e-6"))},
    **{name: (Decimal(size), (0, 1, 0)) for name, size in (("kg", "1"), ("g", "1e-3"))},
    "s": (Decimal(1), (0, 0, 1)),
    **{name: (Decimal(size), (1, 1, -2)) for name, size in
       (("N", "1"), ("mN", "1e-3"), ("kN", "1e3"))},
    **{name: (Decimal(size), (-1, 1, -2)) for name, size in
       (("Pa", "1"), ("kPa", "1e3"), ("MPa", "1e6"), ("GPa", "1e9"))},
    "rad": (Decimal(1), (0, 0, 0)),
    "deg": (_PI / 180, (0, 0, 0)),
    "1": (Decimal(1), (0, 0, 0)),
}  # fmt: skip
_TERM = re.compile(r"(?P<sign>[*/]|^)(?P<name>[A-Za-z]+|1)(?:(?:\^|\*\*)(?P<power>[1-9]))?")
_EXACT = Context(prec=50)


def factor(unit: str, si: str) -> Decimal | Literal["other"] | None:
    """Return the size of a unit in another.

    Parameters
    ----------
    unit, si
        Products of usual units, such as ``"N/cm^2"``.

    Returns
    -------
    Decimal, "other" or None
        ``"other"`` where they are of different dimensions, None where one is not usual.
    """
    if unit == si == "":
        return Decimal(1)
    first, second = _product(unit), _product(si)
    if first is None or second is None:
        return None
    return _EXACT.divide(first[0], second[0]) if first[1] == second[1] else "other"


def _product(text: str) -> tuple[Decimal, list[int]] | None:
    size, powers, end = Decimal(1), [0, 0, 0], 0
    for term in _TERM.finditer(text):
        begins = end == 0
        if term.start() != end or bool(term["sign"]) is begins or term["name"] not in _UNITS:
            return None
        end = term.end()
        each, dimension = _UNITS[term["name"]]
        power = int(term["power"] or 1) * (-1 if term["sign"] == "/" else 1)
        size = _EXACT.multiply(size, _EXACT.power(each, power))
        powers = [a + power * b for a, b in zip(powers, dimension, strict=True)]
    return (size, powers) if end == len(text) and text else None
