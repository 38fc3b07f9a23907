"""The shape of a study's ``settings.json``."""

from __future__ import annotations

from collections.abc import Sized
from typing import Any

from pydantic import BaseModel, ConfigDict, FiniteFloat, NonNegativeInt, ValidationError


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class _Model(_Table):
    name: str
    constants: str | None
    hash: str


class _Parameters(_Table):
    name: str
    labels: list[str]
    units: list[str]
    lower: list[FiniteFloat]
    upper: list[FiniteFloat]


class _Objective(_Table):
    name: str
    force: list[FiniteFloat]


class _Method(_Table):
    name: str
    options: dict[str, Any]


class _Budget(_Table):
    evaluations: int | None
    seconds: FiniteFloat | None


class _Settings(_Table):
    format: int
    flexor: str
    environment: dict[str, str] | None = None  # not in the first studies
    created: str
    model: _Model
    parameters: _Parameters
    objective: _Objective
    method: _Method
    start: list[list[FiniteFloat]] | None
    seed: NonNegativeInt
    engine: dict[str, FiniteFloat]
    budget: _Budget


def complete(values: object) -> bool:
    """Say whether what was read from JSON is all the settings of a study, and of one size.

    Parameters
    ----------
    values
        What was read.
    """
    try:
        settings = _Settings.model_validate(values)
    except ValidationError:
        return False
    parameters = settings.parameters
    rows: list[Sized] = [
        parameters.units,
        parameters.lower,
        parameters.upper,
        *(settings.start or []),
    ]
    return all(len(row) == len(parameters.labels) for row in rows)
