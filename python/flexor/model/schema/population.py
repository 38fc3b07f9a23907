"""Wearers of a device: what changes from one to another."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, model_validator

from flexor.model.schema.table import PositiveNumber, Table, Text
from flexor.model.units import PositiveLength
from flexor.model.validation import describe, field_error


def _two(value: object) -> object:
    if not isinstance(value, (list, tuple)) or len(value) != 2:
        raise field_error(f"is {describe(value)}: write two multiples, such as [0.8, 16.0]")
    return value


class Population(Table):
    """Fields that are proportional to the size of the hand, and joints of varying stiffness.

    See `flexor.scenarios.population`.
    """

    length: tuple[Text, ...] = ()
    breadth: tuple[Text, ...] = ()
    stiffness: tuple[Text, ...] = ()
    hands: Text = "ansur2-men"
    hand_length: PositiveLength | None = None
    hand_breadth: PositiveLength | None = None
    stiffness_range: Annotated[tuple[PositiveNumber, PositiveNumber], BeforeValidator(_two)] = (
        1.0,
        1.0,
    )

    @model_validator(mode="after")
    def _check(self) -> Population:
        low, high = self.stiffness_range
        if low > high:
            tail = f"is {[low, high]}: the first multiple must not be above the second"
            raise field_error(tail, path="stiffness_range")
        return self
