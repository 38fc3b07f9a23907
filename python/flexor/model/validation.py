"""Errors of single fields, and their conversion to messages.

Validators raise `field_error` with the *tail* of the message ("is 10, a number without a unit: …");
`first_error` returns it together with the path of the field.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from pydantic import ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from flexor.errors import shortened

_KIND = "flexor"
_TAILS = {
    "finite_number": "is {input}: it must be a finite number",
    "greater_than": "is {input}: it must be greater than {gt}",
    "greater_than_equal": "is {input}: it must be at least {ge}",
    "less_than_equal": "is {input}: it must be at most {le}",
    "int_type": "is {input}: expected an integer",
    "float_type": "is {input}: expected a number",
    "bool_type": "is {input}: expected true or false",
    "string_type": "is {input}: expected a string in quotes",
    "dict_type": "is {input}: expected a table",
    "model_attributes_type": "is {input}: expected a table",
    "tuple_type": "is {input}: expected a list",
    "too_short": "has too few entries ({actual_length}): expected at least {min_length}",
    "too_long": "has too many entries: expected at most {max_length}",
    "missing": "is missing",
}


def field_error(tail: str, path: str = "") -> PydanticCustomError:
    """Return the exception for a validator to raise."""
    return PydanticCustomError(_KIND, "{tail}", {"tail": tail, "path": path})


def describe(value: object) -> str:
    """Describe a value for use in a message."""
    if isinstance(value, str):
        return '"' + shortened(value).replace("\n", " ") + '"'
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int) and abs(value) > 10**20:
        return "a very large integer"  # str() is limited in digits
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, Mapping):
        return "a table"
    return "a list" if isinstance(value, Sequence) else f"of type {type(value).__name__}"


def first_repeated(names: Iterable[str]) -> str | None:
    """Return the first name that occurs a second time, or None."""
    seen: set[str] = set()
    for name in names:
        if name in seen:
            return name
        seen.add(name)
    return None


def first_error(error: ValidationError, document: Mapping[str, object]) -> tuple[str, str]:
    """Describe the first error that pydantic reports."""
    first = error.errors(include_url=False)[0]
    path = _path(first, document)
    if first["type"] == _KIND:
        relative = first["ctx"]["path"]
        return ".".join(part for part in (path, relative) if part), first["ctx"]["tail"]
    context = first.get("ctx", {})
    tail = _TAILS.get(first["type"])
    if tail is None:
        return path, f"is {describe(first['input'])}: {first['msg']}"
    return path, tail.format_map({**context, "input": describe(first["input"])})


def _path(details: ErrorDetails, document: Mapping[str, object]) -> str:
    node: object = document
    path = ""
    for depth, part in enumerate(details["loc"]):
        if isinstance(part, int) and isinstance(node, Sequence) and part < len(node):
            node, path = node[part], f"{path}[{part}]"
        elif isinstance(node, Mapping) and part in node:
            node, path = node[str(part)], f"{path}.{part}"
        elif details["type"] == "missing" and depth == len(details["loc"]) - 1:
            path = f"{path}.{part}"
    return path.removeprefix(".")
