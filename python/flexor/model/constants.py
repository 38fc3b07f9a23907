"""Named sets of constants in a model file, one of which is in force.

A set gives values to fields of the other tables (``constants.printed.contacts.c.stiffness``). All
sets of a file give the same fields, so that changing from one to another leaves nothing behind.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from flexor.errors import InputError, unknown_name
from flexor.model.fault import shown

Document = Mapping[str, Any]


def names(document: Document, source: str) -> tuple[str, ...]:
    """Return the names of the sets of a document, after checking their form.

    Parameters
    ----------
    document
        The file as TOML has it.
    source
        The file's name, for messages.

    Raises
    ------
    InputError
        If a set gives fields to things that are not there, or not the same fields as the others.
    """
    sets = document.get("constants", {})
    if not isinstance(sets, Mapping):
        raise InputError(f"{source}: constants is {shown(sets)}: a table of sets is needed.")
    for name, values in sets.items():
        if not isinstance(values, Mapping):
            raise InputError(
                f"{source}: constants.{name} is {shown(values)}: a table of fields is needed."
            )
        _check_targets(document, name, values, source)
    fields = {name: set(leaves(values)) for name, values in sets.items()}
    for name, given in fields.items():
        for other, wanted in fields.items():
            if missing := sorted(wanted - given):
                raise InputError(
                    f"{source}: constants.{name}.{missing[0]} is missing: all sets of constants "
                    f"give the same fields, and constants.{other} gives this one."
                )
    return tuple(sets)


def choose(document: Document, wanted: str | None, source: str) -> str | None:
    """Return the name of the set in force: the one wanted, or else the one the file says.

    Parameters
    ----------
    document
        The file as TOML has it.
    wanted
        A set asked for from outside.
    source
        The file's name, for messages.

    Raises
    ------
    InputError
        If there is no such set, or the file has sets and nothing says which one.
    """
    allowed = names(document, source)
    chosen = wanted if wanted is not None else document.get("use")
    if chosen is None:
        if allowed:
            listed = " or ".join(f'"{name}"' for name in allowed)
            raise InputError(
                f"{source}: use is missing: say which constants are in force, {listed}."
            )
        return None
    if chosen not in allowed:
        raise InputError(f"{source}: {unknown_name('set of constants', str(chosen), allowed)}.")
    return str(chosen)


def applied(document: Document, chosen: str | None) -> dict[str, Any]:
    """Return the document with the values of a set in their places.

    Parameters
    ----------
    document
        The file as TOML has it.
    chosen
        The name of one of its sets, or None if it has none.
    """
    if chosen is None:
        return dict(document)
    values: Document = document["constants"][chosen]
    return {**_merged(document, values), "use": chosen}


def leaves(values: Document, above: str = "") -> Iterator[str]:
    """Yield the dotted paths of the fields that a set gives.

    Parameters
    ----------
    values
        The set, or a table within it.
    above
        Dotted path of that table, with its closing dot.
    """
    for key, value in values.items():
        if isinstance(value, Mapping) and value:
            yield from leaves(value, f"{above}{key}.")
        else:
            yield f"{above}{key}"


def _check_targets(document: Document, name: str, values: Document, source: str) -> None:
    tables = [key for key, value in document.items() if isinstance(value, Mapping)]
    tables = [key for key in tables if key != "constants"]
    for table, entries in values.items():
        place = f"{source}: constants.{name}"
        if table not in tables:
            raise InputError(f"{place} has the {unknown_name('table', table, tables)}.")
        if not isinstance(entries, Mapping):
            raise InputError(f"{place}.{table} is {shown(entries)}: a table is needed.")
        for entry in entries:
            if isinstance(entries[entry], Mapping) and entry not in document[table]:
                what = unknown_name("key", entry, document[table])
                raise InputError(f"{place}.{table} has the {what}.")


def _merged(base: Document, over: Document) -> dict[str, Any]:
    result = dict(base)
    for key, value in over.items():
        below = result.get(key)
        if isinstance(value, Mapping) and isinstance(below, Mapping):
            result[key] = _merged(below, value)
        else:
            result[key] = value
    return result
