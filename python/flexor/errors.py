"""The one error that a person can cause: input that cannot be used; and one that nobody need.

The text of `InputError` is always one sentence that says which field of which file, what was found
there and what is allowed; the command line prints it after ``error:`` and exits with code 2. That
of `ClusterError` says what became of the cluster; the exit code is 3, and the study can go on.
"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

__all__ = ["ClusterError", "InputError", "alternatives", "shortened", "unknown", "unknown_name"]

# Names that a sentence lists; the fields of a model file are fewer.
_LISTED = 60


class ClusterError(RuntimeError):
    """A cluster that was lost while it was working, explained in one sentence."""


class InputError(ValueError):
    """Input that cannot be used, explained in one sentence.

    Parameters
    ----------
    sentence
        The explanation; what a terminal cannot show on one line becomes blanks.
    """

    def __init__(self, sentence: str) -> None:
        super().__init__("".join(sign if sign.isprintable() else " " for sign in sentence))


def alternatives(name: str, allowed: Iterable[str]) -> str:
    """Quote a name that is not known, with the nearest that is and all that are.

    Parameters
    ----------
    name
        What was found.
    allowed
        Every name that would have been right.

    Returns
    -------
    str
        For example ``"bendng" (did you mean "bending"?): allowed are "bending", "force"``.
    """
    name = shortened(name)
    names = [shortened(choice) for choice in allowed]
    more = len(names) - _LISTED
    lowered = {choice.lower(): choice for choice in reversed(names)}
    near = get_close_matches(name.lower(), lowered, n=1, cutoff=0.6)
    hint = f' (did you mean "{lowered[near[0]]}"?)' if near else ""
    if not names:
        return f'"{name}": there are none'
    verb = "allowed are" if len(names) > 1 else "allowed is"
    listed = ", ".join(f'"{choice}"' for choice in names[:_LISTED])
    return f'"{name}"{hint}: {verb} {listed}' + (f" and {more} more" if more > 0 else "")


def shortened(text: str, most: int = 60) -> str:
    """Return a text as it may stand in a sentence, cut if it is long.

    Parameters
    ----------
    text
        The text.
    most
        Characters to keep.
    """
    return text if len(text) <= most else f"{text[: most - 1]}…"


def unknown_name(kind: str, name: str, allowed: Iterable[str]) -> str:
    """Describe a name that is not known, with the nearest that is.

    Parameters
    ----------
    kind
        What the name should have named, such as ``"objective"``.
    name
        What was found.
    allowed
        Every name that would have been right.

    Returns
    -------
    str
        For example ``unknown objective "bendng" (did you mean "bending"?): allowed are "bending",
        "force"``, without a closing full stop.
    """
    return f"unknown {kind} {alternatives(name, allowed)}"


def unknown(kind: str, name: str, allowed: Iterable[str]) -> InputError:
    """Return the error for a name that is not known; see `unknown_name`."""
    return InputError(unknown_name(kind, name, allowed) + ".")
