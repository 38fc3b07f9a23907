"""The design space and the load at which designs are evaluated."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from flexor.model import units
from flexor.model.schema.table import Name, Table, Text
from flexor.model.units import PositiveForce, PositiveLength, PositivePressure
from flexor.model.validation import describe, field_error

MAX_STEPS = 10_000
Pair = tuple[PositiveLength, PositiveLength]


def _ordered(pair: Pair) -> Pair:
    low, high = (getattr(bound, "text", repr(bound)) for bound in pair)
    if not pair[0] < pair[1]:
        raise field_error(f'is ["{low}", "{high}"]: the lower bound must be below the upper one')
    return pair


def _two(value: object) -> object:
    if not isinstance(value, (list, tuple)) or len(value) != 2:
        raise field_error(f'is {describe(value)}: write two lengths, such as ["6 cm", "14 cm"]')
    return value


Bounds = Annotated[Pair, BeforeValidator(_two), AfterValidator(_ordered)]


class Design(Table):
    """The rod that is designed and the bounds of the search."""

    rod: Name
    length_bounds: Bounds
    radius_bounds: Bounds
    minimum_radius: PositiveLength

    @model_validator(mode="after")
    def _check(self) -> Design:
        if self.minimum_radius > self.radius_bounds[1]:
            tail = f"is {_original(self.minimum_radius)}: it must not be above the upper of "
            tail += f"radius_bounds, {_original(self.radius_bounds[1])}"
            raise field_error(tail, path="minimum_radius")
        return self


class Evaluation(Table):
    """The load at which objectives are evaluated, reached from zero in equal steps.

    Or ``loads``, by the name of the input and as on the command line.
    """

    force: PositiveForce = units.FORCE.si(5.0)
    step: PositiveForce = units.FORCE.si(1.0)
    pressure: PositivePressure | None = None
    pressure_step: PositivePressure | None = None
    loads: dict[Name, Text] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _check(self) -> Evaluation:
        _check_steps("force", self.force, "step", self.step)
        if self.pressure_step is not None:
            if self.pressure is None:
                raise field_error("is given without pressure", path="pressure_step")
            _check_steps("pressure", self.pressure, "pressure_step", self.pressure_step)
        return self


def _check_steps(load: str, last: float, key: str, step: float) -> None:
    steps = last / step
    if not steps <= MAX_STEPS:
        tail = f"is {_original(step)}: the {load}, {_original(last)}, has more than "
        raise field_error(f"{tail}{MAX_STEPS:,} steps of it", path=key)
    if abs(steps - round(steps)) > 1e-9 * steps:
        tail = f"is {_original(step)}: the {load}, {_original(last)}, must be an "
        raise field_error(f"{tail}integer multiple of it", path=key)


def _original(value: float) -> str:
    return describe(getattr(value, "text", value))
