"""Parsing of TOML."""

from __future__ import annotations

import pathlib
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
# Maximum size of a file [bytes], a thousand times that of a large model.
MAX_BYTES = 10_000_000
# Runs of dotted keys; comments and strings are matched first so that their dots do not count. An
# unclosed string ends with the line or the file, which keeps the scan linear.
_PART = r"""(?:[A-Za-z0-9_-]+|"[^"\\\n]*(?:\\.[^"\\\n]*)*"?|'[^'\n]*'?)"""
_TOKEN = re.compile(
    r"""#[^\n]*"""
    r"""|"{3}[^"\\]*(?:(?:\\.|"(?!""))[^"\\]*)*(?:"{3,5}|\Z)"""
    r"""|'{3}.*?(?:'{3,5}|\Z)"""
    rf"""|(?P<key>{_PART}(?:[ \t]*\.[ \t]*{_PART})*)""",
    re.DOTALL,
)
_POSITION = re.compile(r"(?P<what>.*) \((?P<where>at [^()]*)\)", re.DOTALL)


def tables(text: str, source: str) -> dict[str, Any]:
    """Parse TOML."""
    _check_keys(text, source)
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


def is_special(path: pathlib.Path) -> bool:
    """Return whether a file is a pipe or a device, reading which might not end."""
    return path.exists() and not path.is_file() and not path.is_dir()


def read_text(path: pathlib.Path, what: str) -> str:
    """Read a file of at most ``MAX_BYTES`` as UTF-8."""
    cannot = f'cannot read the {what} "{path}"'
    if is_special(path):
        raise InputError(f"{cannot}: it is not a regular file.")
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        why = getattr(error, "strerror", None) or str(error)
        raise InputError(f"{cannot}: {why.lower()}.") from None
    if len(content) > MAX_BYTES:
        raise InputError(f"{cannot}: it has more than {MAX_BYTES // 1_000_000} MB.")
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{cannot}: byte {error.start} is not valid UTF-8.") from None


def _check_keys(text: str, source: str) -> None:
    """Reject dotted keys of too many parts: to parse one takes a time quadratic in them."""
    for token in _TOKEN.finditer(text):
        key = token["key"]
        if key is not None and key.count(".") >= MAX_DEPTH and _parts(key) > MAX_DEPTH:
            line = text.count("\n", 0, token.start()) + 1
            raise InputError(
                f"{source}: not valid TOML at line {line}: a dotted key has more than "
                f"{MAX_DEPTH} parts."
            )


def _parts(key: str) -> int:
    return len(re.findall(_PART, key))


def check_depth(document: Mapping[str, Any], source: str) -> None:
    """Reject nesting so deep that recursion over it would exhaust the stack."""
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
