"""Reading targets files."""

from __future__ import annotations

import pathlib
import re
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from flexor.calibration.schema import TargetsFile
from flexor.errors import InputError, shortened
from flexor.model.toml import read_text, tables
from flexor.model.validation import first_error

_ENTRY = re.compile(r"(?P<kind>target|constant)\[(?P<index>\d+)\]")


def read(path: str | pathlib.Path) -> tuple[TargetsFile, str]:
    """Read and check a targets file; ``examples/NAME.toml`` also finds one that comes with Flexor.

    Return its content and its text; InputError if it cannot be read, is not TOML, or is not valid.
    """
    place = locate(path)
    text = read_text(place, "targets file")
    return parse(text, str(path)), text


def locate(path: str | pathlib.Path) -> pathlib.Path:
    """Return the file given, or the one that comes with Flexor."""
    given = pathlib.Path(path)
    shipped = pathlib.Path(__file__).resolve().parent.parent / "examples" / given.name
    if not given.exists() and given.parent.name == "examples" and shipped.is_file():
        return shipped
    return given


def parse(text: str, source: str) -> TargetsFile:
    """Read and check the text of a targets file; messages begin with `source`.

    InputError if it is not TOML or not a valid targets file.
    """
    document = tables(text, source)
    try:
        return TargetsFile.model_validate(document)
    except ValidationError as error:
        path, tail = first_error(error, document)
    path = shortened(_named(path, document), 200)
    raise InputError(f"{source}: {path} {tail}." if path else f"{source} {tail}.")


def _named(path: str, document: Mapping[str, Any]) -> str:
    """Replace the index of an entry by its name."""
    match = _ENTRY.match(path)
    if match is None:
        return path
    entry = document[match["kind"]][int(match["index"])]
    name = entry.get("name") if isinstance(entry, Mapping) else None
    return f'{match["kind"]} "{name}"{path[match.end() :]}' if isinstance(name, str) else path
