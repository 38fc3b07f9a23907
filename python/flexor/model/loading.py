"""Loading models by file or preset name."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace

from flexor.errors import InputError
from flexor.model.model import Model
from flexor.model.reading import check, locate
from flexor.model.schema import ModelFile
from flexor.model.toml import read_text
from flexor.model.tunnelling import warn_about_gaps
from flexor.model.validation import describe
from flexor.model.written import Written


def load(
    model: str | os.PathLike[str] | ModelFile,
    variant: str | None = None,
    changes: Mapping[str, object] | None = None,
    *,
    constants: str | None = None,
) -> Model:
    """Load a model.

    Parameters
    ----------
    model
        Path of a model file, name of a preset (see `presets`), or a `ModelFile`.
    variant
        Variant of the file to apply instead of its own choice.
    changes
        Values that override those of the file, by dotted path such as ``"exosuit.length"``.
    constants
        The same as ``variant``.

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
    >>> flexor.load("finger", "printed", changes={"exosuit.length": "8 cm"}).dof
    25
    """
    if variant is not None and constants is not None:
        raise InputError("variant and constants are two names of the same: give one.")
    use = variant if constants is None else constants
    if isinstance(model, ModelFile):
        file = check(model.to_document(), use=use, changes=changes, source=model.name)
        loaded = Model(file)
    elif isinstance(model, (str, os.PathLike)):
        path = locate(model)
        written = Written.of(read_text(path, "model file"), str(path))
        file = check(written.document, use=use, changes=changes, source=str(path), place=path)
        if "parts" in written.document:
            # Its own text says what it is only beside the files of its parts.
            return _warned(Model(file, source=str(path)))
        if use is not None:
            written = replace(written, document={**written.document, "use": use})
        changed = written.with_fields(changes) if changes else written
        if use is None and not changes:
            changed = replace(written, file=file)
        loaded = Model(file, source=str(path), written=changed)
    else:
        raise InputError(f"model is {describe(model)}: expected a file, a preset or a ModelFile.")
    return _warned(loaded)


def _warned(loaded: Model) -> Model:
    warn_about_gaps(loaded)
    return loaded


def changed_model(model: Model, changes: Mapping[str, object]) -> Model:
    """Return a model with other values of fields, in the text of its file, too; see `load`."""
    made = load(model.file, changes=changes)
    made.written = None if model.written is None else model.written.with_fields(changes)
    return made


def require_model(model: Model | str | os.PathLike[str]) -> Model:
    """Return a model or what behaves like one; load what is a file or the name of a preset.

    InputError if it is something else.
    """
    if isinstance(model, (str, os.PathLike)):
        return load(model)
    if not hasattr(model, "evaluate"):
        raise InputError(f"model is {model!r}: expected a Model, a file, or a preset's name.")
    return model
