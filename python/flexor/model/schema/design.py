"""What may be designed, within which bounds, and at which load a design is judged."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, model_validator

from flexor.model import units
from flexor.model.fault import fault, shown
from flexor.model.schema.table import Name, Table
from flexor.model.units import PositiveForce, PositiveLength

MOST_STEPS = 10_000
Pair = tuple[PositiveLength, PositiveLength]


def _ordered(pair: Pair) -> Pair:
    low, high = (getattr(bound, "text", repr(bound)) for bound in pair)
    if not pair[0] < pair[1]:
        raise fault(f'is ["{low}", "{high}"]: the lower bound must be below the upper one')
    return pair


def _two(value: object) -> object:
    if not isinstance(value, (list, tuple)) or len(value) != 2:
        raise fault(f'is {shown(value)}: write two lengths, such as ["6 cm", "14 cm"]')
    return value


Bounds = Annotated[Pair, BeforeValidator(_two), AfterValidator(_ordered)]


class Design(Table):
    """The rod that is designed and the bounds of the search."""

    rod: Name
    length_bounds: Bounds
    radius_bounds: Bounds
    minimum_radius: PositiveLength


class Evaluation(Table):
    """The load at which objectives are evaluated, reached from zero in equal steps."""

    force: PositiveForce = units.FORCE.si(5.0)
    step: PositiveForce = units.FORCE.si(1.0)

    @model_validator(mode="after")
    def _check(self) -> Evaluation:
        steps = self.force / self.step
        if not steps <= MOST_STEPS:
            tail = f"is {_written(self.step)}: the force, {_written(self.force)}, has more than "
            raise fault(f"{tail}{MOST_STEPS:,} steps of it", path="step")
        if abs(steps - round(steps)) > 1e-9 * steps:
            tail = f"is {_written(self.step)}: the force, {_written(self.force)}, must be a whole "
            raise fault(f"{tail}number of steps", path="step")
        return self


def _written(value: float) -> str:
    return shown(getattr(value, "text", value))
