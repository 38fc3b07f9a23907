"""Exceptions of Flexor, and helpers to word their messages.

The message of an `InputError` is one sentence that names the file and the field, what was found
and what is expected; the command line prints it after ``error:`` and exits with code 2. A
`ClusterError` reports the loss of a cluster; the exit code is 3, and the study can be resumed. A
`ModelWarning` is printed after ``warning:``.
"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

__all__ = [
    "ClusterError",
    "InputError",
    "ModelWarning",
    "alternatives",
    "one_line",
    "shortened",
    "unknown",
    "unknown_name",
]

# Maximum number of names listed in a message; a model file has fewer fields.
_MAX_NAMES = 60
# Symbols of fields, which are no closer in spelling than others.
_SYMBOLS = {
    "E": "young_modulus",
    "nu": "poisson_ratio",
    "rho": "density",
    "k": "stiffness",
    "L": "length",
    "R": "radius",
    "S": "radius",
    "g": "gravity",
    "ν": "poisson_ratio",
}


class ClusterError(RuntimeError):
    """The connection to a cluster was lost."""


class InputError(ValueError):
    """Invalid input, explained in one sentence; what is not printable becomes a space."""

    def __init__(self, sentence: str) -> None:
        super().__init__(one_line(sentence))


class ModelWarning(UserWarning):
    """A model that can be used, but whose results may not be what was meant."""

    def __init__(self, sentence: str) -> None:
        super().__init__(one_line(sentence))


def one_line(text: str) -> str:
    """Replace control characters and whatever else is not printable by spaces."""
    return "".join(c if c.isprintable() else " " for c in text)


def alternatives(name: str, allowed: Iterable[str]) -> str:
    """Quote an unknown name, with the closest match and all allowed names.

    For example ``"bendng" (did you mean "bending"?): expected one of "bending", "force"``.
    """
    name = shortened(name)
    names = [shortened(choice) for choice in allowed]
    more = len(names) - _MAX_NAMES
    lowered = {choice.lower(): choice for choice in reversed(names)}
    spelt = _SYMBOLS.get(name, "")
    near = (
        [spelt] if spelt in lowered else get_close_matches(name.lower(), lowered, n=1, cutoff=0.6)
    )
    hint = f' (did you mean "{lowered[near[0]]}"?)' if near else ""
    if not names:
        return f'"{name}": none are defined'
    expected = "expected one of" if len(names) > 1 else "expected"
    listed = ", ".join(f'"{choice}"' for choice in names[:_MAX_NAMES])
    return f'"{name}"{hint}: {expected} {listed}' + (f" and {more} more" if more > 0 else "")


def shortened(text: str, most: int = 60) -> str:
    """Truncate a text to a maximum length, for use in a message."""
    return text if len(text) <= most else f"{text[: most - 1]}…"


def unknown_name(kind: str, name: str, allowed: Iterable[str]) -> str:
    """Say that a name of a kind such as ``"objective"`` is unknown; see `alternatives`."""
    return f"unknown {kind} {alternatives(name, allowed)}"


def unknown(kind: str, name: str, allowed: Iterable[str]) -> InputError:
    """Return the error for an unknown name; see `unknown_name`."""
    return InputError(unknown_name(kind, name, allowed) + ".")
