"""Reading model files and presets, the model files shipped with Flexor."""

from __future__ import annotations

import os
import pathlib
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from flexor.errors import InputError, shortened, unknown_name
from flexor.model import variants
from flexor.model.changes import changed
from flexor.model.schema import ModelFile
from flexor.model.toml import check_depth, read_text, tables
from flexor.model.validation import first_error

_FOLDER = pathlib.Path(__file__).resolve().parent.parent / "examples"


def presets() -> tuple[str, ...]:
    """Return the names of the shipped models."""
    files = (file.stem for file in _FOLDER.glob("*.toml"))
    return tuple(sorted(name for name in files if not name.endswith("-targets")))


def locate(model: str | os.PathLike[str]) -> pathlib.Path:
    """Locate the file of a model."""
    path, text = pathlib.Path(model), os.fspath(model)
    if not text.strip():
        raise InputError("MODEL is empty: give the name of a preset, or the path of a model file.")
    if path.is_file():
        return path
    shipped = presets()
    if text in shipped:
        return _FOLDER / f"{text}.toml"
    if path.parent.name == "examples" and path.suffix == ".toml" and path.stem in shipped:
        return _FOLDER / path.name
    if path.suffix == ".toml" or path.exists() or path.name != text:
        kinds = {path.is_dir(): "it is a folder", not path.exists(): "no such file"}
        why = kinds.get(True, "it is not a regular file")
        raise InputError(f'cannot read the model file "{text}": {why}.')
    raise InputError(f"{unknown_name('preset', text, shipped)}, or the path of a model file.")


def read(
    path: pathlib.Path, use: str | None = None, changes: Mapping[str, object] | None = None
) -> ModelFile:
    """Read and check a model file.

    Parameters
    ----------
    path
        The file.
    use
        Variant to apply instead of the file's own choice.
    changes
        Values that override those of the file, by dotted path; see `flexor.model.changes`.

    Raises
    ------
    InputError
        If it cannot be read, is not valid TOML, or is not a valid model.
    """
    text = read_text(path, "model file")
    return parse(text, use=use, changes=changes, source=str(path))


def parse(
    text: str,
    use: str | None = None,
    changes: Mapping[str, object] | None = None,
    source: str = "model",
) -> ModelFile:
    """Read and check the text of a model file.

    Parameters
    ----------
    text
        The text.
    use, changes
        As for `read`.
    source
        The file's name, for messages.

    Raises
    ------
    InputError
        If it is not valid TOML or not a valid model.
    """
    return check(tables(text, source), use=use, changes=changes, source=source)


def check(
    document: Mapping[str, Any],
    use: str | None = None,
    changes: Mapping[str, object] | None = None,
    source: str = "model",
) -> ModelFile:
    """Validate a parsed model file with each of its variants."""
    check_depth(document, source)
    for path, value in (changes or {}).items():
        document = changed(document, path, value, source)
    chosen = variants.choose(document, use, source)
    for name in variants.names(document, source):
        if name != chosen:
            _validated(document, name, source)
    return _validated(document, chosen, source)


def with_changes(file: ModelFile, values: Mapping[str, Any], source: str) -> ModelFile:
    """Return a file with changes such as those of a variant, and no variants of its own.

    InputError, beginning with ``source``, if it is then no valid model.
    """
    document = file.to_document()
    return _validated(variants.with_changes(document, values), None, source)


def _validated(document: Mapping[str, Any], chosen: str | None, source: str) -> ModelFile:
    complete = variants.applied(document, chosen)
    try:
        return ModelFile.model_validate(complete)
    except ValidationError as error:
        path, tail = first_error(error, complete)
    path = shortened(variants.place(document, chosen, path), 200)
    raise InputError(f"{source}: {path} {tail}." if path else f"{source}: it {tail}.")
