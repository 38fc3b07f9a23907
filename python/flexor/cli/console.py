"""Output streams of the commands: results to stdout, progress and errors to stderr."""

from __future__ import annotations

import codecs
import json
import math
import sys
import warnings
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.text import Text

from flexor.errors import ModelWarning, one_line

_REPLACEMENTS = {
    "°": "deg",
    "−": "-",
    "×": "x",
    "·": "-",
    "…": "...",
    "“": '"',
    "”": '"',
    "→": "->",
}


class _PlainConsole(Console):
    """A console that prints text literally: no markup, and no control characters."""

    def print(self, *objects: Any, **options: Any) -> None:
        """Print texts and tables."""
        shown = [plain(each) if isinstance(each, str) else each for each in objects]
        super().print(*shown, **options)


out = _PlainConsole(highlight=False)
err = _PlainConsole(stderr=True, highlight=False)


def plain(text: str) -> Text:
    """Return a text, possibly from a file, without control characters except line breaks."""
    return Text("\n".join(one_line(line) for line in text.split("\n")))


def replace_unencodable_characters() -> None:
    """Replace characters that a stream cannot encode (``LANG=C``) instead of raising errors."""
    codecs.register_error("flexor", _replacement)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="flexor")


def _replacement(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    missing = error.object[error.start : error.end]
    return "".join(_REPLACEMENTS.get(each, "?") for each in missing), error.end


def say(text: str) -> None:
    """Print a line of results to stdout, without wrapping."""
    out.print(text, soft_wrap=True)


def note(text: str) -> None:
    """Print a line to stderr, without wrapping."""
    err.print(text, soft_wrap=True)


def print_error(sentence: str) -> None:
    """Print an error message to stderr; its line breaks become spaces."""
    note(f"error: {' '.join(sentence.split())}")


def print_warnings() -> None:
    """Print warnings about models as a line to stderr each, others as Python does."""
    others = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *rest: Any) -> None:
        if issubclass(category, ModelWarning):
            note(f"warning: {message}")
        else:
            others(message, category, *rest)

    warnings.simplefilter("always", ModelWarning)
    warnings.showwarning = show  # type: ignore[assignment]  # with fewer names


def print_json(values: Mapping[str, Any]) -> None:
    """Print a JSON object to stdout: dataclasses as objects, null for numbers not finite."""
    print(json.dumps(_plain_value(values), allow_nan=False))


def _plain_value(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        value = asdict(value)
    if isinstance(value, Mapping):
        return {key: _plain_value(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain_value(each) for each in value]
    if isinstance(value, Path):
        return str(value)
    return None if isinstance(value, float) and not math.isfinite(value) else value
