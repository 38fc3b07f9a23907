"""Numeric fields of a model file: finding one by its dotted path, and replacing its value."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from pydantic import BaseModel, TypeAdapter, ValidationError

from flexor.errors import InputError, unknown_name
from flexor.model.changes import resolve
from flexor.model.schema import ModelFile
from flexor.model.schema.profile import Spline, Taper
from flexor.model.units import Quantity
from flexor.model.validation import describe, first_error


def keys_of(path: str, file: ModelFile) -> tuple[str, ...]:
    """Return the keys of a field, with its table in front.

    Parameters
    ----------
    path
        Dotted, such as ``"exosuit.length"``, ``"bodies.exosuit.section.wall"`` or
        ``"exosuit.radius.1"``; entries of lists are numbered from 0, and the number may be left out
        where there is one entry.
    file
        The model file.

    Raises
    ------
    InputError
        If there is no such field, the nearest name being said, or its value is not a number.
    """
    walked, node = _found(path, file)
    if isinstance(node, bool) or not isinstance(node, float):
        raise InputError(f'field "{path}" cannot be varied: {_why_not(path, node)}.')
    return walked


def constant_radius(path: str, file: ModelFile) -> tuple[str, ...]:
    """Return the fields of a radius that is the same from base to tip; none if it is not one."""
    try:
        _, node = _found(path, file)
    except InputError:
        return ()
    if not isinstance(node, Taper) or node.base != node.tip:
        return ()
    return f"{path}.base", f"{path}.tip"


def _found(path: str, file: ModelFile) -> tuple[tuple[str, ...], Any]:
    """Return the keys of a field, and its value."""
    keys = resolve(file.to_document(), path.strip().split("."), f'field "{path}"')
    node: Any = file
    walked: list[str] = []
    for key in keys:
        if isinstance(node, tuple) and not key.isdigit() and len(node) == 1:
            node = node[0]
            walked.append("0")
        node = _child(node, key, path)
        walked.append(key)
    return tuple(walked), node


def _why_not(path: str, node: Any) -> str:
    if node is None:
        return "it is not given in the file"
    if isinstance(node, int) and not isinstance(node, bool):
        choice = f'--choose "{path}={node},{2 * node}"'
        return f"{node} is a whole number: give values to choose from, such as {choice}"
    what = "which is not a number"
    if isinstance(node, BaseModel):
        numbers = [f'"{path}.{each}"' for each, value in node if isinstance(value, float)]
        what = f"whose numbers are {' and '.join(numbers)}" if numbers else what
    return f"its value is {_said(node)}, {what}"


def value_of(keys: Sequence[str], file: ModelFile) -> float:
    """Return the value of a field, SI; a `Quantity` where it has a unit."""
    node: Any = file
    for key in keys:
        node = _child(node, key, ".".join(keys))
    found: float = node
    return found


def refusal(keys: Sequence[str], value: str | float, file: ModelFile) -> str:
    """Say why a field cannot have a value on its own, whatever other fields have.

    Parameters
    ----------
    keys
        Of the field.
    value
        As a model file has it, with its unit.
    file
        The model file.

    Returns
    -------
    str
        Such as ``"it must be greater than zero"``; empty if it can.
    """
    node: Any = file
    table, rest = node, tuple(keys)
    for i, key in enumerate(keys):
        if isinstance(node, BaseModel):
            table, rest = node, tuple(keys[i:])
        node = _child(node, key, ".".join(keys))
    known = type(table).model_fields[rest[0]]
    whole = _replaced(getattr(table, rest[0]), rest[1:], value) if rest[1:] else value
    kind: Any = known.annotation
    if known.metadata:
        kind = Annotated[(kind, *known.metadata)]
    try:
        TypeAdapter(kind).validate_python(whole)
    except ValidationError as error:
        return first_error(error, {})[1].partition(": ")[2]
    return ""


def spline_of(keys: Sequence[str], file: ModelFile) -> tuple[str, ...] | None:
    """Return the keys of the size along a rod of which a field is a control value; None if none."""
    size = tuple(keys[:-2])
    if len(keys) < 3 or keys[-2] != "spline":
        return None
    return size if isinstance(value_of(size, file), Spline) else None


def replaced(file: ModelFile, values: Mapping[tuple[str, ...], Any]) -> ModelFile:
    """Return a file with other values of some fields, SI, or tables, which are not checked.

    Parameters
    ----------
    file
        The model file.
    values
        By the keys of a field.
    """
    for keys, value in values.items():
        file = _replaced(file, keys, value)
    return file


def _replaced(node: Any, keys: Sequence[str], value: Any) -> Any:
    if not keys:
        number = isinstance(node, Quantity) and not isinstance(value, str)
        return Quantity(value, node.text) if number else value
    key, rest = keys[0], keys[1:]
    changed = _replaced(_child(node, key, key), rest, value)
    if isinstance(node, tuple):
        return (*node[: int(key)], changed, *node[int(key) + 1 :])
    if isinstance(node, dict):
        return {**node, key: changed}
    return node.model_copy(update={key: changed})


def _child(node: Any, key: str, path: str) -> Any:
    if isinstance(node, tuple):
        if key.isdigit() and int(key) < len(node):
            return node[int(key)]
        raise InputError(f'field "{path}": the list has no entry "{key}", but {len(node)} entries.')
    names = node if isinstance(node, dict) else getattr(type(node), "model_fields", None)
    if names is None:
        raise InputError(f'field "{path}": there is no "{key}" in a single value.')
    if key not in names:
        raise InputError(f'field "{path}": {unknown_name("key", key, names)}.')
    return node[key] if isinstance(node, dict) else getattr(node, key)


def _said(node: Any) -> str:
    return describe(node) if isinstance(node, (str, bool, int, tuple)) else "a table"
