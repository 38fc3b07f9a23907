"""The schema of targets files: constants with ranges, and targets with tolerances."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from flexor.model.schema.table import Choice, Count, Name, Table, Text
from flexor.model.validation import describe, field_error, first_repeated

QUANTITIES = (
    "bending",
    "angle",
    "tip-force",
    "contacts",
    "obstacle-force",
    "x",
    "y",
    "z",
    "rotation",
    "optimum",
)
_OF = {
    "angle": "the joint",
    "obstacle-force": "the obstacle",
    "x": "the body",
    "y": "the body",
    "z": "the body",
    "rotation": "the body",
    "optimum": 'what of the optimum, a parameter of the set or "bending"',
}


def _pair(value: object) -> object:
    if not isinstance(value, (list, tuple)) or len(value) != 2:
        raise field_error(f'is {describe(value)}: write two values, such as ["10 kPa", "10 MPa"]')
    return value


def _list(value: object) -> object:
    return [value] if isinstance(value, str) else value


def _at(value: object) -> object:
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if number and 0.0 <= value <= 1.0:  # type: ignore[operator]
        return float(value)  # type: ignore[arg-type]
    if value not in ("base", "tip"):
        allowed = 'expected one of "base", "tip" or a fraction from 0 to 1'
        raise field_error(f"is {describe(value)}: {allowed}")
    return value


def _file(value: object) -> object:
    return {"file": value} if isinstance(value, str) else value


class ModelFile(Table):
    """A model: a preset or a file beside the targets file, with values for some of its fields."""

    file: Text
    set: dict[Name, Any] = Field(default_factory=dict)


Models = dict[Name, Annotated[ModelFile, BeforeValidator(_file)]]


class Constant(Table):
    """A constant to be fitted: fields of the models that share one value."""

    name: Name
    fields: Annotated[tuple[Name, ...], Field(min_length=1), BeforeValidator(_list)]
    range: Annotated[tuple[Any, Any], BeforeValidator(_pair)]
    scale: Annotated[Literal["linear", "log"], Choice("linear", "log")] = "linear"


class Target(Table):
    """One measured or published observable of a model, or a series of them along the load.

    ``value`` is one value, met at the last of the forces, or a list with one for each force.
    """

    name: Name
    model: Name | None = None
    observable: Annotated[str, Choice(*QUANTITIES)]
    of: Name | None = None
    at: Annotated[Literal["base", "tip"] | float, BeforeValidator(_at)] = "tip"
    force: Any = None
    parameters: Text | None = None
    design: dict[Name, Any] | None = None
    objective: Text = "bending"
    method: Text = "pattern-search"
    options: dict[Name, Any] = Field(default_factory=dict)
    value: Any
    tolerance: Any = None
    weight: Annotated[Literal["hard", "soft", "held-out"], Choice("hard", "soft", "held-out")] = (
        "soft"
    )

    @model_validator(mode="after")
    def _check(self) -> Target:
        needs = _OF.get(self.observable)
        if needs is not None and self.of is None:
            raise field_error(f'is missing: "{self.observable}" needs {needs}', path="of")
        if needs is None and self.of is not None:
            raise field_error(
                f'is "{self.of}": "{self.observable}" is of the whole model', path="of"
            )
        optimum = self.observable == "optimum"
        if self.parameters is None and (optimum or self.design is not None):
            what = "an optimum" if optimum else "a design"
            raise field_error(
                f'is missing: {what} is of a parameter set, such as "L+R01"', "parameters"
            )
        if optimum and self.design is not None:
            raise field_error("is given, but an optimum looks for the design itself", path="design")
        if self.parameters is not None and not optimum and self.design is None:
            raise field_error("is missing: give the values of the parameters", path="design")
        if self.tolerance is None and self.weight != "held-out":
            raise field_error('is missing: write it with its unit or as "1 %"', path="tolerance")
        return self


class Search(Table):
    """Effort: points of the global search, and how many of them are refined."""

    samples: Count | None = None
    starts: Count = 12


class TargetsFile(Table):
    """A whole targets file."""

    title: Text = ""
    models: Models = Field(default_factory=dict)
    search: Search = Search()
    constant: tuple[Constant, ...] = ()
    target: tuple[Target, ...] = ()

    @model_validator(mode="after")
    def _check(self) -> TargetsFile:
        if not self.target:
            raise field_error("has no [[target]]: give at least one value to be met")
        if all(target.weight == "held-out" for target in self.target):
            raise field_error("has held-out targets only: at least one must be hard or soft")
        if not self.constant:
            raise field_error("has no [[constant]]: give at least one that is to be found")
        for kind in ("constant", "target"):
            _check_different([entry.name for entry in getattr(self, kind)], kind)
        return self


def _check_different(names: list[str], kind: str) -> None:
    if (name := first_repeated(names)) is not None:
        index = names.index(name, names.index(name) + 1)
        raise field_error(f"has the name {describe(name)} twice", path=f"{kind}[{index}]")
