"""Variants of a model and sets of constants in its file, one of which is active.

Both assign values to fields of the other tables (``variants.long.bodies.rod.length``). A variant
changes what it names and may have a ``weight``; all sets of constants of a file define the same
fields, so that switching sets overrides all of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from flexor.errors import InputError, unknown_name
from flexor.model.validation import describe

Document = Mapping[str, Any]
MAX_SETS = 50  # each is checked with the whole model
TABLES = ("constants", "variants")


def names(document: Document, source: str) -> tuple[str, ...]:
    """Validate the sets of a document and return their names."""
    for table in TABLES:
        sets = document.get(table, {})
        if not isinstance(sets, Mapping):
            raise InputError(f"{source}: {table} is {describe(sets)}: expected a table of sets.")
        if len(sets) > MAX_SETS:
            raise InputError(f"{source}: {table} has {len(sets):,} sets: at most {MAX_SETS}.")
        for name, values in sets.items():
            if not isinstance(values, Mapping):
                raise InputError(
                    f"{source}: {table}.{name} is {describe(values)}: expected a table of fields."
                )
            _check_targets(document, f"{table}.{name}", _changes(values), source)
    variants = document.get("variants", {})
    for name in variants:
        if name in document.get("constants", {}):
            raise InputError(f"{source}: variants.{name} has the name of a set of constants.")
    fields = {name: set(leaves(values)) for name, values in document.get("constants", {}).items()}
    for name, defined in fields.items():
        for other, expected in fields.items():
            if missing := sorted(expected - defined):
                raise InputError(
                    f"{source}: constants.{name}.{missing[0]} is missing: all sets of constants "
                    f"must define the same fields, and constants.{other} defines it."
                )
    weights(document, source)
    return (*fields, *variants)


def weights(document: Document, source: str) -> dict[str, float]:
    """Return the weight of each variant, 1 unless it has one."""
    found = {}
    for name, values in document.get("variants", {}).items():
        weight = values.get("weight", 1.0)
        number = isinstance(weight, (int, float)) and not isinstance(weight, bool)
        if not number or not 0.0 < weight < math.inf:
            tail = f"variants.{name}.weight is {describe(weight)}: it must be a number above 0"
            raise InputError(f"{source}: {tail}.")
        found[name] = float(weight)
    return found


def choose(document: Document, requested: str | None, source: str) -> str | None:
    """Return the name of the active set: the requested one, or else that selected by the file.

    None where there are no sets of constants, and no variant is selected.
    """
    allowed = names(document, source)
    chosen = requested if requested is not None else document.get("use")
    if chosen is None:
        if document.get("constants"):
            listed = " or ".join(f'"{name}"' for name in allowed)
            raise InputError(f"{source}: use is missing: select a set of constants, {listed}.")
        return None
    if chosen not in allowed:
        kind = "variant" if document.get("variants") else "set of constants"
        raise InputError(f"{source}: {unknown_name(kind, str(chosen), allowed)}.")
    return str(chosen)


def applied(document: Document, chosen: str | None) -> dict[str, Any]:
    """Return the document with the values of a set applied."""
    if chosen is None:
        return dict(document)
    if chosen in document.get("variants", {}):
        base = document.get("use")
        if base in document.get("constants", {}):
            document = applied(document, base)
        changed = _merged(document, _changes(document["variants"][chosen]))
        # No other set can be applied to what is left.
        return {key: value for key, value in changed.items() if key not in (*TABLES, "use")}
    values: Document = document["constants"][chosen]
    return {**_merged(document, values), "use": chosen}


def place(document: Document, chosen: str | None, path: str) -> str:
    """Return the full path of a field, which may be one that the chosen set defines."""
    for table in TABLES:
        values = document.get(table, {}).get(chosen)
        if values is not None and path in leaves(_changes(values)):
            return f"{table}.{chosen}.{path}"
    return path


def _changes(values: Document) -> Document:
    return {key: value for key, value in values.items() if key != "weight"}


def leaves(values: Document, prefix: str = "") -> Iterator[str]:
    """Yield the dotted paths of the fields that a set defines."""
    for key, value in values.items():
        if isinstance(value, Mapping) and value:
            yield from leaves(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}"


def _check_targets(document: Document, path: str, values: Document, source: str) -> None:
    tables = [key for key, value in document.items() if isinstance(value, Mapping)]
    tables = [key for key in tables if key not in TABLES]
    for table, entries in values.items():
        place = f"{source}: {path}"
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
