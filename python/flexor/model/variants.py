"""Variants of a model in its file, one of which may be applied.

A variant assigns values to fields of the other tables (``variants.long.bodies.rod.length``) and may
have a ``weight``. Sets of ``constants`` are variants all of which define the same fields, one of
them always applied, so that switching sets overrides every value of another. Variants of a file
with sets of constants change the set in use.
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
    """Validate the variants and sets of constants of a document and return their names."""
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
            _check_targets(document, f"{table}.{name}", changes(values), source)
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
    """Return the name of the variant to apply: the requested one, or else that of the file.

    None where none is to be applied.
    """
    allowed = names(document, source)
    chosen = requested if requested is not None else document.get("use")
    if chosen is None:
        if document.get("constants"):
            listed = " or ".join(f'"{name}"' for name in allowed)
            raise InputError(f"{source}: use is missing: select a set of constants, {listed}.")
        return None
    if chosen not in allowed:
        kind = "set of constants" if document.get("constants") else "variant"
        raise InputError(f"{source}: {unknown_name(kind, str(chosen), allowed)}.")
    return str(chosen)


def applied(document: Document, chosen: str | None) -> dict[str, Any]:
    """Return the document with a variant or a set of constants applied.

    Its other variants then restore what this one has changed, so that each of them can be applied
    to the result as to the document.
    """
    if chosen is None:
        return dict(document)
    sets: Document = document.get("constants", {})
    if chosen in sets:
        return {**merged(document, sets[chosen]), "use": chosen}
    base = without(document)
    result = merged(base, changes(document["variants"][chosen]))
    variants = {}
    for name, values in document["variants"].items():
        if name == chosen:
            variants[name] = values
        elif (restored := leading(result, merged(base, changes(values)))) is not None:
            variants[name] = merged(restored, values)
    return {**result, "variants": variants, "use": chosen}


def without(document: Document) -> dict[str, Any]:
    """Return the document without variants, with the set of constants that it uses."""
    return with_changes(document, document.get("constants", {}).get(document.get("use", ""), {}))


def with_changes(document: Document, values: Document) -> dict[str, Any]:
    """Return a document with changes such as those of a variant, and no variants of its own."""
    base = {key: value for key, value in document.items() if key not in (*TABLES, "use")}
    return merged(base, changes(values))


def place(document: Document, chosen: str | None, path: str) -> str:
    """Return the full path of a field, which may be one that the chosen variant defines."""
    for table in TABLES:
        values = document.get(table, {}).get(chosen)
        if values is not None and path in leaves(changes(values)):
            return f"{table}.{chosen}.{path}"
    return path


def changes(values: Document) -> Document:
    """Return what a variant changes, without its weight."""
    return {key: value for key, value in values.items() if key != "weight"}


def leaves(values: Document) -> Iterator[str]:
    """Yield the dotted paths of the fields that a variant defines."""
    return (".".join(keys) for keys in leaf_keys(values))


def leaf_keys(values: Document, above: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Yield the keys of the fields that a variant defines."""
    for key, value in values.items():
        if isinstance(value, Mapping) and value:
            yield from leaf_keys(value, (*above, key))
        else:
            yield (*above, key)


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


def merged(base: Document, override: Document) -> dict[str, Any]:
    """Return a table with values of another; one of another kind takes its place."""
    result = dict(base)
    for key, value in override.items():
        existing = result.get(key)
        if isinstance(existing, Mapping) and _mergeable(existing, value):
            result[key] = merged(existing, value)
        else:
            result[key] = value
    return result


def _mergeable(existing: object, value: object) -> bool:
    """Return whether two values are tables of the same kind."""
    if not (isinstance(existing, Mapping) and isinstance(value, Mapping)):
        return False
    return "kind" not in value or value["kind"] == existing.get("kind")


def leading(here: Document, there: Document) -> dict[str, Any] | None:
    """Return the changes that lead from one document to another; None if there are none."""
    if set(here) - set(there):
        return None  # a field cannot be taken away
    found: dict[str, Any] = {}
    for key, value in there.items():
        if key in here and here[key] == value:
            continue
        if key not in here or not _mergeable(here[key], value):
            found[key] = value
        elif (within := leading(here[key], value)) is not None:
            found[key] = within
        else:
            return None
    return found
