"""The design problem and the load at which designs are evaluated."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field, Strict, model_validator

from flexor.model import units
from flexor.model.schema.table import Name, Number, Table, Text
from flexor.model.units import PositiveForce, PositiveLength, PositivePressure
from flexor.model.validation import describe, field_error, first_repeated

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


End = Text | Number
# One text, or several.
Texts = Annotated[
    tuple[Text, ...], BeforeValidator(lambda value: (value,) if isinstance(value, str) else value)
]


class Variable(Table):
    """A field of the file that varies: a numeric one within bounds, or any among choices.

    With a ``profile`` such as ``"spline 4"`` it is a size that varies along a rod. The choices may
    be ``"with"`` and ``"without"``.
    """

    field: Text
    bounds: tuple[End, End] | None = None
    choices: tuple[End, ...] = ()
    profile: Text | None = None

    @property
    def range(self) -> tuple[End, ...]:
        """The bounds, followed by the profile if there is one."""
        return (*(self.bounds or ()), *(() if self.profile is None else (self.profile,)))

    @model_validator(mode="after")
    def _check(self) -> Variable:
        if self.bounds is None and not self.choices:
            tail = "is missing: a variable has bounds or choices"
            raise field_error(tail, path="bounds")
        if self.choices and (self.bounds is not None or self.profile is not None):
            tail = "is given as well as choices: a variable has one of them"
            raise field_error(tail, path="bounds" if self.bounds is not None else "profile")
        return self


class Design(Table):
    """What varies and what is wanted.

    Parameter sets vary ``rod`` within the bounds of its length and radius; ``variable`` are any
    numeric fields of the file. ``scenarios`` are variants under which designs are evaluated,
    ``tolerance`` the errors of fields for which constraints hold; see `flexor.optimize`.
    """

    rod: Name | None = None
    length_bounds: Bounds | None = None
    radius_bounds: Bounds | None = None
    minimum_radius: PositiveLength | None = None
    variable: tuple[Variable, ...] = ()
    maximise: Texts = ()
    minimise: Texts = ()
    subject_to: tuple[Text, ...] = ()
    without: tuple[Text, ...] = ()
    scenarios: tuple[Text, ...] = ()
    aggregate: Text = "mean"
    tolerance: dict[Text, End] = Field(default_factory=dict)
    samples: Annotated[int, Strict(), Field(ge=0)] = 0

    @property
    def aims(self) -> tuple[str, ...]:
        """What is wanted, such as ``"maximise bending"``; empty if the file does not say."""
        more = [f"maximise {name}" for name in self.maximise]
        return (*more, *(f"minimise {name}" for name in self.minimise))

    @property
    def varied(self) -> dict[str, tuple[End, ...]]:
        """Bounds of the variables by field, with the profile of those that vary along a rod."""
        return {each.field: each.range for each in self.variable if each.bounds is not None}

    @property
    def choices(self) -> dict[str, tuple[End, ...]]:
        """Values among which others are chosen, by field."""
        return {each.field: each.choices for each in self.variable if each.choices}

    @model_validator(mode="after")
    def _check(self) -> Design:
        if (twice := first_repeated((*self.maximise, *self.minimise))) is not None:
            key = "minimise" if twice in self.minimise else "maximise"
            raise field_error(f"has {describe(twice)} twice: objectives must differ", path=key)
        fields = [each.field for each in self.variable]
        if (twice := first_repeated(fields)) is not None:
            tail = f"is {describe(twice)}, as that of another variable"
            raise field_error(
                tail, f"variable[{len(fields) - 1 - fields[::-1].index(twice)}].field"
            )
        space = ("rod", "length_bounds", "radius_bounds", "minimum_radius")
        missing = [key for key in space if getattr(self, key) is None]
        if missing and (len(missing) < len(space) or not self.variable):
            hint = f": {units.LENGTH.hint}" if missing[0] == "minimum_radius" else ""
            raise field_error(f"is missing{hint}", path=missing[0])
        if self.minimum_radius is None or self.radius_bounds is None:
            return self
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
