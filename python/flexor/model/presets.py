"""Model files shipped with Flexor."""

from __future__ import annotations

import os
import pathlib

from flexor.errors import InputError, unknown_name

_FOLDER = pathlib.Path(__file__).resolve().parent.parent / "examples"


def presets() -> tuple[str, ...]:
    """Return the names of the shipped models."""
    files = (file.stem for file in _FOLDER.glob("*.toml"))
    return tuple(sorted(name for name in files if not name.endswith("-targets")))


def locate(model: str | os.PathLike[str]) -> pathlib.Path:
    """Locate the file of a model.

    Parameters
    ----------
    model
        Path of a model file, or name of a preset. ``examples/NAME.toml`` falls back to the preset
        if there is no such file, so that the documented commands work in any directory.

    Raises
    ------
    InputError
        If neither a file nor a preset is found.
    """
    path, text = pathlib.Path(model), os.fspath(model)
    if path.is_file():
        return path
    shipped = presets()
    if text in shipped:
        return _FOLDER / f"{text}.toml"
    if path.parent.name == "examples" and path.suffix == ".toml" and path.stem in shipped:
        return _FOLDER / path.name
    if path.suffix == ".toml" or path.exists() or path.name != text:
        why = "it is a folder" if path.is_dir() else "no such file"
        raise InputError(f'cannot read the model file "{text}": {why}.')
    raise InputError(f"{unknown_name('preset', text, shipped)}, or the path of a model file.")
