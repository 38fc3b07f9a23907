"""Checks of arguments, in the words of the command line."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Integral
from typing import Any

from flexor.errors import InputError


def integer(name: str, value: Any, least: int) -> int:
    """Return an argument that must be an integer of at least ``least``; InputError otherwise."""
    if isinstance(value, bool) or not isinstance(value, Integral):
        raise InputError(f"{_found(name, value)}: it must be an integer of at least {least}.")
    if int(value) < least:
        raise InputError(f"{_found(name, int(value))}: it must be at least {least}.")
    return int(value)


def check_callable(name: str, value: Any) -> None:
    """Require a function or None; InputError otherwise."""
    if value is not None and not callable(value):
        raise InputError(f"{_found(name, value)}: it must be a function.")


def assignments(option: str, pairs: Sequence[str], example: str) -> dict[str, str]:
    """Parse `key=value` pairs; the option and a valid pair are for messages."""
    result: dict[str, str] = {}
    for pair in pairs:
        key, equals, value = (part.strip() for part in pair.partition("="))
        if not (key and equals and value):
            raise InputError(f'{option} is "{pair}": give key=value, such as "{example}".')
        if key in result:
            raise InputError(f'{option} sets "{key}" twice.')
        result[key] = value
    return result


def _found(name: str, value: object) -> str:
    from flexor.model.validation import describe  # deferred: slow to import

    return f"{name} is {describe(value)}"
