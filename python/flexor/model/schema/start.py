"""Where paths begin: coordinates by the names of bodies."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator

from flexor.model.schema.table import Name
from flexor.model.validation import describe, field_error

StartValue = str | float


def _value(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, (str, int, float)):
        raise field_error(f'is {describe(value)}: write a coordinate, such as "20 deg"')
    return value


def _entry(value: object) -> object:
    return value if isinstance(value, dict) else _value(value)


_Value = Annotated[StartValue, BeforeValidator(_value)]
StartTable = dict[Name, Annotated[StartValue | dict[Name, _Value], BeforeValidator(_entry)]]
