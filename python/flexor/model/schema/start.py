"""Where paths begin: coordinates by the names of bodies."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator

from flexor.model.fault import fault, shown
from flexor.model.schema.table import Name

StartValue = str | float


def _value(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, (str, int, float)):
        raise fault(f'is {shown(value)}: write a coordinate, such as "20 deg"')
    return value


def _entry(value: object) -> object:
    return value if isinstance(value, dict) else _value(value)


_Value = Annotated[StartValue, BeforeValidator(_value)]
StartTable = dict[Name, Annotated[StartValue | dict[Name, _Value], BeforeValidator(_entry)]]
