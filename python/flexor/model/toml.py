"""Parsing of TOML."""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from flexor.errors import InputError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

# Maximum nesting depth, far beyond that of any valid file.
MAX_DEPTH = 30
_POSITION = re.compile(r"(?P<what>.*) \((?P<where>at [^()]*)\)", re.DOTALL)


def tables(text: str, source: str) -> dict[str, Any]:
    """Parse TOML.

    Parameters
    ----------
    text
        The text.
    source
        The file's name, for messages.

    Raises
    ------
    InputError
        If it is not valid TOML or nested too deeply.
    """
    try:
        document = tomllib.loads(text)
    except ValueError as error:  # includes integers beyond Python's digit limit
        match = _POSITION.fullmatch(str(error))
        what, where = (match["what"], match["where"]) if match else (str(error), "somewhere")
        raise InputError(
            f"{source}: not valid TOML {where}: {what[0].lower()}{what[1:]}."
        ) from None
    except RecursionError:
        raise InputError(f"{source}: not valid TOML: tables are nested too deeply.") from None
    check_depth(document, source)
    return document


def check_depth(document: Mapping[str, Any], source: str) -> None:
    """Reject nesting so deep that recursion over it would exhaust the stack.

    Parameters
    ----------
    document
        The parsed file.
    source
        The file's name, for messages.

    Raises
    ------
    InputError
        If they are nested more than ``MAX_DEPTH`` times.
    """
    level: list[Any] = [document]
    for _ in range(MAX_DEPTH):
        level = [child for each in level for child in _children(each)]
        if not level:
            return
    raise InputError(f"{source}: tables and lists are nested more than {MAX_DEPTH} levels deep.")


def _children(value: Any) -> list[Any]:
    """Return the tables and lists directly contained in a value."""
    if isinstance(value, Mapping):
        value = value.values()
    elif not isinstance(value, Sequence) or isinstance(value, (str, bytes)):
        return []
    return [each for each in value if isinstance(each, (Mapping, list, tuple))]
