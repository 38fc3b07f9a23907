"""Loading models by file or preset name."""

from __future__ import annotations

import os
from collections.abc import Mapping

from flexor.errors import InputError
from flexor.model.model import Model
from flexor.model.reading import check, locate, read
from flexor.model.schema import ModelFile
from flexor.model.tunnelling import warn_about_gaps
from flexor.model.validation import describe


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
        Variant or set of constants to use instead of the file's own choice.
    changes
        Values that override those of the file, by dotted path such as ``"exosuit.length"``.

    Raises
    ------
    InputError
        If the model does not exist or its file is invalid.

    Warns
    -----
    ModelWarning
        If its contact spheres stand so far apart that contacts may be missed.

    Examples
    --------
    >>> flexor.load("finger").dof
    25
    >>> flexor.load("finger", constants="printed", changes={"exosuit.length": "8 cm"}).dof
    25
    """
    if isinstance(model, ModelFile):
        file = check(model.to_document(), use=constants, changes=changes, source=model.name)
        loaded = Model(file)
    elif isinstance(model, (str, os.PathLike)):
        path = locate(model)
        loaded = Model(read(path, use=constants, changes=changes), source=str(path))
    else:
        raise InputError(f"model is {describe(model)}: expected a file, a preset or a ModelFile.")
    warn_about_gaps(loaded)
    return loaded


def require_model(model: Model) -> Model:
    """Return the argument if it is a model or behaves like one."""
    if not hasattr(model, "design"):
        raise InputError(f"model is {model!r}: expected a Model, as returned by flexor.load.")
    return model
