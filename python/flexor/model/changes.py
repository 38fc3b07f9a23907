"""Changing single fields of a model file by their dotted path."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from typing import Any

from flexor.errors import InputError, unknown_name
from flexor.model.fault import shown
from flexor.model.schema import ModelFile
from flexor.model.toml import DEEPEST

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

Document = Mapping[str, Any]
_NAMED = ("bodies", "contacts", "obstacles", "actuators", "springs", "wrenches", "spheres")


def changed(document: Document, path: str, value: object, source: str) -> dict[str, Any]:
    """Return a document with another value in one place.

    Parameters
    ----------
    document
        A model file as TOML has it.
    path
        Dotted path such as ``"bodies.exosuit.length"``, or from the name of a thing on, such as
        ``"exosuit.length"``.
    value
        The value, or its text as it would stand in the file (``"8 cm"``, ``"0.3"``). Where sets of
        constants give this field, it is changed in all of them.
    source
        The file's name, for messages.

    Raises
    ------
    InputError
        If the path starts at nothing in the file.
    """
    keys = path.split(".")
    if len(keys) > DEEPEST:
        raise InputError(f"{source}: {shown(path)} has more than {DEEPEST} parts: no field has.")
    keys = _located(document, keys, source)
    value = _typed(value) if isinstance(value, str) else value
    result = _with(document, keys, value)
    sets = document.get("constants")
    if isinstance(sets, Mapping):
        result["constants"] = {
            name: _with(values, keys, value) if _gives(values, keys) else values
            for name, values in sets.items()
        }
    return result


def _located(document: Document, keys: list[str], source: str) -> list[str]:
    things: dict[str, str] = {}
    for table in _NAMED:
        for name in document.get(table, {}):
            things.setdefault(name, table)
    if keys[0] not in ModelFile.model_fields:
        if keys[0] not in things:
            allowed = (*things, *ModelFile.model_fields)
            raise InputError(f"{source}: {unknown_name('field', keys[0], allowed)}.")
        keys = [things[keys[0]], *keys]
    if keys[0] in ("constants", "use"):
        raise InputError(
            f"{source}: {keys[0]} cannot be changed: choose a set of constants by name."
        )
    if keys[0] in _NAMED and len(keys) > 1 and keys[1] not in document.get(keys[0], {}):
        what = unknown_name("entry", keys[1], document.get(keys[0], {}))
        raise InputError(f"{source}: {keys[0]} has the {what}.")
    if keys[0] in _NAMED and len(keys) < 3:
        raise InputError(f"{source}: {'.'.join(keys)} is a table: change its fields one by one.")
    return keys


def _with(table: object, keys: Sequence[str], value: object) -> dict[str, Any]:
    here = dict(table) if isinstance(table, Mapping) else {}
    first, rest = keys[0], keys[1:]
    here[first] = _with(here.get(first), rest, value) if rest else value
    return here


def _gives(values: object, keys: Sequence[str]) -> bool:
    for key in keys:
        if not isinstance(values, Mapping) or key not in values:
            return False
        values = values[key]
    return True


def _typed(text: str) -> object:
    """Read numbers, switches and tables as TOML does; the rest is text."""
    try:
        return tomllib.loads(f"value = {text}")["value"] if "\n" not in text else text
    except tomllib.TOMLDecodeError:
        return text
