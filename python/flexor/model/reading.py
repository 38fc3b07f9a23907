"""Reading model files."""

from __future__ import annotations

import pathlib
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from flexor.errors import InputError, shortened
from flexor.model import constants
from flexor.model.changes import changed
from flexor.model.schema import ModelFile
from flexor.model.toml import check_depth, tables
from flexor.model.validation import first_error


def read(
    path: pathlib.Path, use: str | None = None, changes: Mapping[str, object] | None = None
) -> ModelFile:
    """Read and check a model file.

    Parameters
    ----------
    path
        The file.
    use
        Set of constants to use instead of the file's own choice.
    changes
        Values that override those of the file, by dotted path; see `flexor.model.changes`.

    Raises
    ------
    InputError
        If it cannot be read, is not valid TOML, or is not a valid model.
    """
    try:
        text = path.read_bytes().decode("utf-8")
    except UnicodeDecodeError as error:
        why = f"byte {error.start} is not valid UTF-8"
        raise InputError(f'cannot read the model file "{path}": {why}.') from None
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise InputError(f'cannot read the model file "{path}": {why}.') from None
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
    """Validate a parsed model file with each of its sets of constants.

    Parameters
    ----------
    document
        The file's tables.
    use, changes, source
        As for `parse`.

    Raises
    ------
    InputError
        If it is not a valid model.
    """
    check_depth(document, source)
    for path, value in (changes or {}).items():
        document = changed(document, path, value, source)
    chosen = constants.choose(document, use, source)
    for name in constants.names(document, source):
        if name != chosen:
            _validated(document, name, source)
    return _validated(document, chosen, source)


def _validated(document: Mapping[str, Any], chosen: str | None, source: str) -> ModelFile:
    complete = constants.applied(document, chosen)
    try:
        return ModelFile.model_validate(complete)
    except ValidationError as error:
        path, tail = first_error(error, complete)
    if chosen is not None and path in constants.leaves(document["constants"][chosen]):
        path = f"constants.{chosen}.{path}"
    path = shortened(path, 200)
    raise InputError(f"{source}: {path} {tail}." if path else f"{source}: it {tail}.")
