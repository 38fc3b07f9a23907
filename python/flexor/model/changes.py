"""Overriding fields of a model file by dotted path."""

from __future__ import annotations

import sys
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from flexor.errors import InputError, unknown_name
from flexor.model import variants
from flexor.model.schema import ModelFile
from flexor.model.schema.material import own_keys
from flexor.model.toml import MAX_DEPTH
from flexor.model.validation import describe

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

Document = Mapping[str, Any]
_NAMED = tuple(ModelFile.named_tables())


def changed(document: Document, path: str, value: object, source: str) -> dict[str, Any]:
    """Return a document with one field changed, in all variants that define it.

    The path is dotted, such as ``"bodies.exosuit.length"``, or begins with a named entry, such as
    ``"exosuit.length"``; a value may be its text in a model file (``"8 cm"``, ``"0.3"``).
    """
    keys = path.split(".")
    if len(keys) > MAX_DEPTH:
        raise InputError(f"{source}: {describe(path)} has more than {MAX_DEPTH} parts.")
    keys = resolve(document, keys, source)
    value = _parse_value(value) if isinstance(value, str) else value
    if keys[0] == "materials" and keys[2:] == ["library"]:
        # What was taken from the other material of the library is not kept.
        table = document["materials"][keys[1]]
        document = _with(document, keys[:2], own_keys(table))
    result: dict[str, Any] = _with(document, keys, value)
    for table in variants.TABLES:
        sets = document.get(table)
        if not isinstance(sets, Mapping):
            continue
        result[table] = {
            name: _with(values, keys, value) if _defines(values, keys) else values
            for name, values in sets.items()
        }
    return result


def removed(document: Document, path: str, source: str) -> dict[str, Any]:
    """Return a document without a field or an entry, such as ``"middle"``, also in its variants."""
    keys = path_of(document, path, source)
    result: dict[str, Any] = _without(document, keys)
    for table in variants.TABLES:
        sets = document.get(table)
        if isinstance(sets, Mapping):
            result[table] = {
                name: _without(values, keys) if _defines(values, keys) else values
                for name, values in sets.items()
            }
    return result


def path_of(document: Document, path: str, source: str) -> list[str]:
    """Return the keys of a field or of an entry; InputError if the document does not have it."""
    keys = path.strip().split(".")
    name = ".".join(keys)
    if found_in := [table for table in _NAMED if name in document.get(table, {})][:1]:
        keys = [*found_in, name]
    if not (len(keys) == 2 and keys[0] in _NAMED):
        keys = resolve(document, keys, source)
    node: Any = document
    found: list[str] = []
    for key in keys:
        if isinstance(node, (list, tuple)) and not key.isdigit() and len(node) == 1:
            node = node[0]
            found.append("0")
        try:
            node = node[int(key)] if isinstance(node, (list, tuple)) else node[key]
        except (KeyError, IndexError, ValueError, TypeError):
            names = node if isinstance(node, Mapping) else {}
            what = unknown_name("key", key, names) if names else f'nothing called "{key}"'
            raise InputError(f'{source}: "{path}" is not in the file: {what}.') from None
        found.append(key)
    return found


def _without(table: Any, keys: Sequence[str]) -> Any:
    if isinstance(table, (list, tuple)):
        i = int(keys[0])
        inside = [_without(table[i], keys[1:])] if len(keys) > 1 else []
        return [*table[:i], *inside, *table[i + 1 :]]
    if len(keys) == 1:
        return {key: value for key, value in table.items() if key != keys[0]}
    return {**table, keys[0]: _without(table[keys[0]], keys[1:])}


def resolve(document: Document, keys: list[str], source: str) -> list[str]:
    """Return the keys of a field with its table in front; InputError if there is no such entry."""
    tables: dict[str, str] = {}
    for table in _NAMED:
        for name in document.get(table, {}):
            tables.setdefault(name, table)
    if keys[0] == "parts":
        return _of_a_part(document, keys, source)
    if keys[0] not in ModelFile.model_fields:
        keys = with_whole_name(keys, tables)
        if keys[0] not in tables:
            allowed = (*tables, *ModelFile.known_keys())
            raise InputError(f"{source}: {unknown_name('field', keys[0], allowed)}.")
        keys = [tables[keys[0]], *keys]
    elif keys[:2] == ["evaluation", "loads"]:
        keys = [*keys[:2], ".".join(keys[2:])] if len(keys) > 2 else keys
    elif keys[0] in _NAMED:
        keys = [keys[0], *with_whole_name(keys[1:], document.get(keys[0], {}))]
    if keys[0] in (*variants.TABLES, "use"):
        raise InputError(f"{source}: {keys[0]} cannot be changed: select a variant by name.")
    if keys[0] in _NAMED and len(keys) > 1 and keys[1] not in document.get(keys[0], {}):
        what = unknown_name("entry", keys[1], document.get(keys[0], {}))
        raise InputError(f"{source}: {keys[0]} has an {what}.")
    if keys[0] in _NAMED and len(keys) < 3:
        raise InputError(f"{source}: {'.'.join(keys)} is a table: change its fields individually.")
    return keys


def with_whole_name(keys: Sequence[str], names: Collection[str]) -> list[str]:
    """Return keys of which the first is a name that has dots, if one of the names is that.

    If none is but their first part is that of a part of the model, it is what the name would be.
    """
    keys = list(keys)
    for end in range(len(keys), 1, -1):
        if (name := ".".join(keys[:end])) in names:
            return [name, *keys[end:]]
    alike = [name.count(".") for name in names if keys and name.startswith(f"{keys[0]}.")]
    if not alike or keys[0] in names:
        return keys
    end = min(alike) + 1
    return [".".join(keys[:end]), *keys[end:]]


def _of_a_part(document: Document, keys: list[str], source: str) -> list[str]:
    """Return the keys of a field of a part, ``parts.index.scale``."""
    known = document.get("parts", {})
    if not known:
        tail = "the entries of its parts are its own, such as index.exosuit.length"
        raise InputError(f'{source}: "{".".join(keys)}" is no field of a model: {tail}.')
    if len(keys) < 2 or keys[1] not in known:
        what = unknown_name("part", keys[1] if len(keys) > 1 else "", known)
        raise InputError(f"{source}: parts has an {what}.")
    if len(keys) < 3:
        tail = "is a table: change its fields individually"
        raise InputError(f"{source}: {'.'.join(keys)} {tail}.")
    return [*keys[:3], ".".join(keys[3:])] if keys[2] == "set" and len(keys) > 3 else keys


def _with(table: object, keys: Sequence[str], value: object) -> Any:
    if isinstance(table, (list, tuple)):
        # Entries are numbered from 0; the number may be left out where there is one.
        place, rest = (keys[0], keys[1:]) if keys[0].isdigit() else ("0", keys)
        if int(place) < len(table) and (keys[0].isdigit() or len(table) == 1):
            changed = _with(table[int(place)], rest, value) if rest else value
            return [*table[: int(place)], changed, *table[int(place) + 1 :]]
    result = dict(table) if isinstance(table, Mapping) else {}
    first, rest = keys[0], keys[1:]
    result[first] = _with(result.get(first), rest, value) if rest else value
    return result


def _defines(values: object, keys: Sequence[str]) -> bool:
    for key in keys:
        if not isinstance(values, Mapping) or key not in values:
            return False
        values = values[key]
    return True


def _parse_value(text: str) -> object:
    """Parse a TOML value; anything that is not TOML is text."""
    try:
        return tomllib.loads(f"value = {text}")["value"] if "\n" not in text else text
    except tomllib.TOMLDecodeError:
        return text
