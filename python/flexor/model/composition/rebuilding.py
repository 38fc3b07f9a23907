"""Changing the tables of a checked model, one after another."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from flexor.model.schema.table import Table

Change = Callable[[Table], Mapping[str, Any]]


def rebuilt(value: Any, change: Change) -> Any:
    """Return a value in which each table has other fields, those in it first.

    Parameters
    ----------
    value
        A table, or what a field of one holds.
    change
        Returns the fields that change, by name. They are not checked.
    """
    if isinstance(value, Table):
        inner = {
            name: new
            for name in type(value).model_fields
            if (new := rebuilt(old := getattr(value, name), change)) is not old
        }
        made = value.model_copy(update=inner) if inner else value
        fields = change(made)
        return made.model_copy(update=dict(fields)) if fields else made
    if isinstance(value, tuple):
        items = tuple(rebuilt(each, change) for each in value)
        return value if all(new is old for new, old in zip(items, value, strict=True)) else items
    if isinstance(value, dict):
        return {key: rebuilt(each, change) for key, each in value.items()}
    return value
