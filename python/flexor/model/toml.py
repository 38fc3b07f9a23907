"""TOML as text, read into tables or refused in one sentence."""

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

# Tables within tables; no file that Flexor reads needs a third of them.
DEEPEST = 30
_POSITION = re.compile(r"(?P<what>.*) \((?P<where>at [^()]*)\)", re.DOTALL)


def tables(text: str, source: str) -> dict[str, Any]:
    """Read TOML.

    Parameters
    ----------
    text
        The text.
    source
        The file's name, for messages.

    Raises
    ------
    InputError
        If it is not TOML, or nested more deeply than anything that Flexor reads.
    """
    try:
        document = tomllib.loads(text)
    except ValueError as error:  # also numbers of more digits than Python reads
        match = _POSITION.fullmatch(str(error))
        what, where = (match["what"], match["where"]) if match else (str(error), "somewhere")
        raise InputError(
            f"{source}: not valid TOML {where}: {what[0].lower()}{what[1:]}."
        ) from None
    except RecursionError:
        raise InputError(f"{source}: not valid TOML: its tables are nested too deeply.") from None
    check_depth(document, source)
    return document


def check_depth(document: Mapping[str, Any], source: str) -> None:
    """Refuse tables so deep that walking through them would exhaust Python's stack.

    Parameters
    ----------
    document
        What was read.
    source
        The file's name, for messages.

    Raises
    ------
    InputError
        If they are nested more than ``DEEPEST`` times.
    """
    level: list[Any] = [document]
    for _ in range(DEEPEST):
        level = [inner for each in level for inner in _inside(each)]
        if not level:
            return
    raise InputError(
        f"{source}: its tables and lists are nested more than {DEEPEST} times: no field is so deep."
    )


def _inside(value: Any) -> list[Any]:
    """Tables and lists directly in a value."""
    if isinstance(value, Mapping):
        value = value.values()
    elif not isinstance(value, Sequence) or isinstance(value, (str, bytes)):
        return []
    return [each for each in value if isinstance(each, (Mapping, list, tuple))]
