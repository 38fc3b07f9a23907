"""From a name or a file to a model."""

from __future__ import annotations

import os
from collections.abc import Mapping

from flexor.errors import InputError
from flexor.model.model import Model
from flexor.model.presets import locate
from flexor.model.reading import check, read
from flexor.model.schema import ModelFile


def load(
    model: str | os.PathLike[str] | ModelFile,
    constants: str | None = None,
    changes: Mapping[str, object] | None = None,
) -> Model:
    """Load a model.

    Parameters
    ----------
    model
        Path of a model file, name of a preset (see `presets`), or a `ModelFile`.
    constants
        Which of the file's sets of constants to put in force, if not the one it says.
    changes
        Values to put in place of the file's, by dotted path such as ``"exosuit.length"``.

    Raises
    ------
    InputError
        If there is no such model, or the file does not describe one.

    Examples
    --------
    >>> flexor.load("finger").dof
    25
    >>> flexor.load("finger", constants="printed", changes={"exosuit.length": "8 cm"}).dof
    25
    """
    if isinstance(model, ModelFile):
        return Model(check(model.to_document(), use=constants, changes=changes, source=model.name))
    path = locate(model)
    return Model(read(path, use=constants, changes=changes), source=str(path))


def needed_model(given: Model) -> Model:
    """Return what was given where a model is needed, or what behaves like one.

    Raises
    ------
    InputError
        If it is something else, such as the name of a file.
    """
    if not hasattr(given, "design"):
        raise InputError(f"model is {given!r}: a Model is needed; flexor.load makes one.")
    return given
