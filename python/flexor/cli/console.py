"""Output streams of the commands: results to stdout, progress and errors to stderr."""

from __future__ import annotations

import codecs
import sys
import warnings
from typing import Any

from rich.console import Console
from rich.text import Text

from flexor.errors import ModelWarning, one_line

_SPELT = {"°": "deg", "−": "-", "×": "x", "·": "-", "…": "...", "“": '"', "”": '"', "→": "->"}


class _PlainConsole(Console):
    """A console on which texts are what they are: no markup, and no control characters."""

    def print(self, *objects: Any, **options: Any) -> None:
        """Print texts and tables."""
        shown = [plain(each) if isinstance(each, str) else each for each in objects]
        super().print(*shown, **options)


out = _PlainConsole(highlight=False)
err = _PlainConsole(stderr=True, highlight=False)


def plain(text: str) -> Text:
    """Return a text, possibly from somebody's file, as it is shown: line breaks stay."""
    return Text("\n".join(one_line(line) for line in text.split("\n")))


def spell_what_streams_lack() -> None:
    """Let streams of few characters (``LANG=C``) spell others instead of raising errors."""
    codecs.register_error("flexor", _spelt)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="flexor")


def _spelt(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    missing = error.object[error.start : error.end]
    return "".join(_SPELT.get(each, "?") for each in missing), error.end


def say(sentence: str) -> None:
    """Print a line of results to stdout, without markup or wrapping."""
    out.print(sentence, markup=False, soft_wrap=True)


def print_error(sentence: str) -> None:
    """Print an error message to stderr, without markup or wrapping.

    Parameters
    ----------
    sentence : str
        The message; line breaks become spaces.
    """
    err.print(f"error: {' '.join(sentence.split())}", markup=False, soft_wrap=True)


def print_warnings() -> None:
    """Print warnings about models as a line to stderr each, others as Python does."""
    others = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *rest: Any) -> None:
        if issubclass(category, ModelWarning):
            err.print(f"warning: {message}", markup=False, soft_wrap=True)
        else:
            others(message, category, *rest)

    warnings.simplefilter("always", ModelWarning)
    warnings.showwarning = show  # type: ignore[assignment]  # with fewer names
