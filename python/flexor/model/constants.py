"""Named sets of constants in a model file, one of which is active.

A set assigns values to fields of the other tables (``constants.printed.contacts.c.stiffness``).
All sets of a file define the same fields, so that switching sets overrides all of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from flexor.errors import InputError, unknown_name
from flexor.model.validation import describe

Document = Mapping[str, Any]
MAX_SETS = 50  # each is checked with the whole model


def names(document: Document, source: str) -> tuple[str, ...]:
    """Validate the sets of a document and return their names."""
    sets = document.get("constants", {})
    if not isinstance(sets, Mapping):
        raise InputError(f"{source}: constants is {describe(sets)}: expected a table of sets.")
    if len(sets) > MAX_SETS:
        raise InputError(f"{source}: constants has {len(sets):,} sets: at most {MAX_SETS}.")
    for name, values in sets.items():
        if not isinstance(values, Mapping):
            raise InputError(
                f"{source}: constants.{name} is {describe(values)}: expected a table of fields."
            )
        _check_targets(document, name, values, source)
    fields = {name: set(leaves(values)) for name, values in sets.items()}
    for name, defined in fields.items():
        for other, expected in fields.items():
            if missing := sorted(expected - defined):
                raise InputError(
                    f"{source}: constants.{name}.{missing[0]} is missing: all sets of constants "
                    f"must define the same fields, and constants.{other} defines it."
                )
    return tuple(sets)


def choose(document: Document, requested: str | None, source: str) -> str | None:
    """Return the name of the active set: the requested one, or else that selected by the file."""
    allowed = names(document, source)
    chosen = requested if requested is not None else document.get("use")
    if chosen is None:
        if allowed:
            listed = " or ".join(f'"{name}"' for name in allowed)
            raise InputError(f"{source}: use is missing: select a set of constants, {listed}.")
        return None
    if chosen not in allowed:
        raise InputError(f"{source}: {unknown_name('set of constants', str(chosen), allowed)}.")
    return str(chosen)


def applied(document: Document, chosen: str | None) -> dict[str, Any]:
    """Return the document with the values of a set applied."""
    if chosen is None:
        return dict(document)
    values: Document = document["constants"][chosen]
    return {**_merged(document, values), "use": chosen}


def leaves(values: Document, prefix: str = "") -> Iterator[str]:
    """Yield the dotted paths of the fields that a set defines."""
    for key, value in values.items():
        if isinstance(value, Mapping) and value:
            yield from leaves(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}"


def _check_targets(document: Document, name: str, values: Document, source: str) -> None:
    tables = [key for key, value in document.items() if isinstance(value, Mapping)]
    tables = [key for key in tables if key != "constants"]
    for table, entries in values.items():
        place = f"{source}: constants.{name}"
        if table not in tables:
            raise InputError(f"{place} has an {unknown_name('table', table, tables)}.")
        if not isinstance(entries, Mapping):
            raise InputError(f"{place}.{table} is {describe(entries)}: expected a table.")
        for entry in entries:
            if isinstance(entries[entry], Mapping) and entry not in document[table]:
                what = unknown_name("key", entry, document[table])
                raise InputError(f"{place}.{table} has an {what}.")


def _merged(base: Document, override: Document) -> dict[str, Any]:
    result = dict(base)
    for key, value in override.items():
        existing = result.get(key)
        if isinstance(value, Mapping) and isinstance(existing, Mapping):
            result[key] = _merged(existing, value)
        else:
            result[key] = value
    return result
