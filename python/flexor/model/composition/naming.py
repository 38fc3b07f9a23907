"""Names of a part in the model that it is a part of."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, get_args

from pydantic.fields import FieldInfo

from flexor.model.composition.rebuilding import rebuilt
from flexor.model.schema.table import EntryName, Table


def renamed(table: Table, names: Collection[str], prefix: str) -> Table:
    """Return a table in which references to entries have a prefix.

    Parameters
    ----------
    table
        The table.
    names
        The entries whose names get it.
    prefix
        Such as ``"index."``.
    """

    def change(each: Table) -> Mapping[str, Any]:
        made = {}
        for name, field in type(each).model_fields.items():
            old = getattr(each, name)
            if _refers(field) and (new := with_prefix(old, names, prefix)) != old:
                made[name] = new
        return made

    made: Table = rebuilt(table, change)
    return made


def with_prefix(value: Any, names: Collection[str], prefix: str) -> Any:
    """Return a name, or a tuple of names, with a prefix if it is one of the given ones."""
    if isinstance(value, tuple):
        return tuple(with_prefix(each, names, prefix) for each in value)
    return f"{prefix}{value}" if isinstance(value, str) and value in names else value


def _refers(field: FieldInfo) -> bool:
    """Whether a field holds names of entries."""
    return any(isinstance(each, EntryName) for each in field.metadata) or _mentions(
        field.annotation
    )


def _mentions(annotation: Any) -> bool:
    parts = get_args(annotation)
    return any(isinstance(part, EntryName) or _mentions(part) for part in parts)
