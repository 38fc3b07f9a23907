"""Base class and field types of the tables."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Protocol, cast, runtime_checkable

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
from flexor.model.validation import describe, field_error

if TYPE_CHECKING:
    from typing_extensions import Self

Number = Annotated[float, Strict(), Field(allow_inf_nan=False)]
NonNegativeNumber = Annotated[float, Strict(), Field(ge=0.0, allow_inf_nan=False)]
PositiveNumber = Annotated[float, Strict(), Field(gt=0.0, allow_inf_nan=False)]
Count = Annotated[int, Strict(), Field(ge=1)]
Index = Annotated[int, Strict(), Field(ge=0, le=1_000_000)]
Switch = Annotated[bool, Strict()]
Text = Annotated[str, Strict()]


class EntryName:
    """Annotation of a field that holds the name of an entry of the file."""


Name = Annotated[str, Strict(), EntryName()]


class Choice:
    """Pydantic annotation: one of the given names."""

    def __init__(self, *names: str) -> None:
        self.names = names

    @property
    def hint(self) -> str:
        """Expected input, for the end of an error message."""
        return "expected one of " + ", ".join(f'"{name}"' for name in self.names)

    def __get_pydantic_core_schema__(
        self, source: type[Any], handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Check the name before the field's own validation."""

        def check(value: object) -> object:
            if not isinstance(value, str):
                raise field_error(f"is {describe(value)}: {self.hint}")
            if value not in self.names:
                raise field_error(f"is {alternatives(value, self.names)}")
            return value

        return core_schema.no_info_before_validator_function(check, handler(source))


@runtime_checkable
class _Hinted(Protocol):
    @property
    def hint(self) -> str: ...


class Table(BaseModel):
    """An immutable table that allows only its declared keys."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    def __copy__(self) -> Self:
        """Copy the fields; what was derived from them is not that of a copy with other values."""
        copied = super().__copy__()
        for name in copied.__dict__.keys() - type(self).model_fields.keys():
            del copied.__dict__[name]
        return copied

    @classmethod
    def known_keys(cls) -> tuple[str, ...]:
        """Return the keys that a table may have where it is written."""
        return tuple(cls.model_fields)

    @model_validator(mode="before")
    @classmethod
    def _check_keys(cls, data: object) -> object:
        """Reject unknown and missing keys before any field is validated."""
        if isinstance(data, cls):
            return data
        if not isinstance(data, Mapping):
            raise field_error(f"is {describe(data)}: expected a table with {_listed(cls)}")
        for key in data:
            if key not in cls.model_fields:
                raise field_error("has an " + unknown_name("key", str(key), cls.known_keys()))
        for name, field in cls.model_fields.items():
            if field.is_required() and name not in data:
                hint = next((m.hint for m in field.metadata if isinstance(m, _Hinted)), None)
                raise field_error(f"is missing: {hint}" if hint else "is missing", path=name)
        return data


def _listed(table: type[Table]) -> str:
    return ", ".join(table.known_keys())


def one_of(*kinds: str) -> Callable[[object], object]:
    """Return a validator that requires a table whose ``kind`` is one of the given ones."""

    def check(value: object) -> object:
        if isinstance(value, Table):
            return value
        if not isinstance(value, Mapping):
            raise field_error(f"is {describe(value)}: expected a table with a kind")
        if "kind" not in value:
            allowed = ", ".join(f'"{kind}"' for kind in kinds)
            raise field_error(f"is missing: expected one of {allowed}", path="kind")
        if value["kind"] not in kinds:
            raise field_error(f"has an {unknown_name('kind', str(value['kind']), kinds)}")
        return cast("Mapping[str, Any]", value)

    return check
