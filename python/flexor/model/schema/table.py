"""What every table of a model file has in common."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Protocol, cast, runtime_checkable

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    Strict,
    model_validator,
)
from pydantic_core import CoreSchema, core_schema

from flexor.errors import alternatives, unknown_name
from flexor.model.fault import fault, shown

Number = Annotated[float, Strict(), Field(allow_inf_nan=False)]
PositiveNumber = Annotated[float, Strict(), Field(gt=0.0, allow_inf_nan=False)]
Count = Annotated[int, Strict(), Field(ge=1)]
Index = Annotated[int, Strict(), Field(ge=0, le=1_000_000)]
Switch = Annotated[bool, Strict()]
Text = Annotated[str, Strict()]
Name = Annotated[str, Strict()]


@dataclass(frozen=True)
class Choice:
    """Pydantic marker: one of these names.

    Parameters
    ----------
    *names
        The names allowed.
    """

    names: tuple[str, ...]

    def __init__(self, *names: str) -> None:
        object.__setattr__(self, "names", names)

    @property
    def hint(self) -> str:
        """What to write, for the end of an error message."""
        return "allowed are " + ", ".join(f'"{name}"' for name in self.names)

    def __get_pydantic_core_schema__(
        self, source: type[Any], handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Tell pydantic to look at the name first."""

        def check(value: object) -> object:
            if not isinstance(value, str):
                raise fault(f"is {shown(value)}: {self.hint}")
            if value not in self.names:
                raise fault(f"is {alternatives(value, self.names)}")
            return value

        return core_schema.no_info_before_validator_function(check, handler(source))


@runtime_checkable
class _Hinted(Protocol):
    @property
    def hint(self) -> str: ...


class Table(BaseModel):
    """A table with exactly the keys it declares, read once and never changed."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @model_validator(mode="before")
    @classmethod
    def _check_keys(cls, data: object) -> object:
        """Refuse unknown keys (with the near match) before anything else is looked at."""
        if isinstance(data, cls):
            return data
        if not isinstance(data, Mapping):
            raise fault(f"is {shown(data)}: a table with {_listed(cls)} is needed")
        for key in data:
            if key not in cls.model_fields:
                raise fault("has the " + unknown_name("key", str(key), cls.model_fields))
        for name, field in cls.model_fields.items():
            if field.is_required() and name not in data:
                hint = next((m.hint for m in field.metadata if isinstance(m, _Hinted)), None)
                raise fault(f"is missing: {hint}" if hint else "is missing", path=name)
        return data


def _listed(table: type[Table]) -> str:
    return ", ".join(table.model_fields)


def one_of(*kinds: str) -> Callable[[object], object]:
    """Return a validator that demands a table whose ``kind`` is one of these.

    Parameters
    ----------
    *kinds
        The kinds allowed.
    """

    def check(value: object) -> object:
        if isinstance(value, Table):
            return value
        if not isinstance(value, Mapping):
            raise fault(f"is {shown(value)}: a table with its kind is needed")
        if "kind" not in value:
            allowed = ", ".join(f'"{kind}"' for kind in kinds)
            raise fault(f"is missing: allowed are {allowed}", path="kind")
        if value["kind"] not in kinds:
            raise fault(f"has the {unknown_name('kind', str(value['kind']), kinds)}")
        return cast("Mapping[str, Any]", value)

    return check
