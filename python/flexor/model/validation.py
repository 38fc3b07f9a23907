"""What is wrong with one field, said so that a sentence can be made of it.

Validators raise a fault with the *tail* of the sentence ("is 10, a number without a unit: …");
`sentence` puts the file and the field in front of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pydantic import ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from flexor.errors import shortened

_KIND = "flexor"
_TAILS = {
    "finite_number": "is {input}: it must be a finite number",
    "greater_than": "is {input}: it must be greater than {gt}",
    "greater_than_equal": "is {input}: it must be at least {ge}",
    "less_than_equal": "is {input}: it must be at most {le}",
    "int_type": "is {input}: a whole number is needed",
    "float_type": "is {input}: a number is needed",
    "bool_type": "is {input}: true or false is needed",
    "string_type": "is {input}: text in quotes is needed",
    "dict_type": "is {input}: a table is needed",
    "model_attributes_type": "is {input}: a table is needed",
    "tuple_type": "is {input}: a list is needed",
    "too_short": "has too few entries ({actual_length}): at least {min_length} are needed",
    "missing": "is missing",
}


def fault(tail: str, path: str = "") -> PydanticCustomError:
    """Return the exception for a validator to raise.

    Parameters
    ----------
    tail
        The sentence after the name of the field, without its full stop.
    path
        Dotted path of the field below the place where the validator sits.
    """
    return PydanticCustomError(_KIND, "{tail}", {"tail": tail, "path": path})


def shown(value: object) -> str:
    """Return a value as it may stand in a sentence."""
    if isinstance(value, str):
        return '"' + shortened(value).replace("\n", " ") + '"'
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int) and abs(value) > 10**20:
        return "a whole number of many digits"  # Python refuses to print the longest
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, Mapping):
        return "a table"
    return "a list" if isinstance(value, Sequence) else f"of type {type(value).__name__}"


def sentence(error: ValidationError, document: Mapping[str, object]) -> tuple[str, str]:
    """Describe the first thing that pydantic found wrong.

    Parameters
    ----------
    error
        Everything that pydantic found.
    document
        What it was given, to tell the keys in a location from the names of union members.

    Returns
    -------
    path, tail : str
        The dotted path of the field, and the sentence after it without its full stop.
    """
    first = error.errors(include_url=False)[0]
    path = _path(first, document)
    if first["type"] == _KIND:
        below = first["ctx"]["path"]
        return ".".join(part for part in (path, below) if part), first["ctx"]["tail"]
    context = first.get("ctx", {})
    tail = _TAILS.get(first["type"])
    if tail is None:
        return path, f"is {shown(first['input'])}: {first['msg']}"
    return path, tail.format_map({**context, "input": shown(first["input"])})


def _path(details: ErrorDetails, document: Mapping[str, object]) -> str:
    here: object = document
    path = ""
    for depth, part in enumerate(details["loc"]):
        if isinstance(part, int) and isinstance(here, Sequence) and part < len(here):
            here, path = here[part], f"{path}[{part}]"
        elif isinstance(here, Mapping) and part in here:
            here, path = here[str(part)], f"{path}.{part}"
        elif details["type"] == "missing" and depth == len(details["loc"]) - 1:
            path = f"{path}.{part}"
    return path.removeprefix(".")
