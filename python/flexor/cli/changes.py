"""Model files with some fields changed on the command line."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexor.cli.values import assignments

if TYPE_CHECKING:
    from flexor.model import Model


def load_changed(model: str, constants: str | None, changes: list[str]) -> Model:
    """Load a model with some of its fields changed.

    Parameters
    ----------
    model : str
        Model file or preset.
    constants : str or None
        Which set of constants to use, if not the file's own choice.
    changes : list of str
        Such as `["exosuit.length=8 cm"]`.

    Returns
    -------
    Model
        The changed model.

    Raises
    ------
    InputError
        If there is no such model or field, or the value cannot be used.
    """
    from flexor.model import load

    return load(model, constants, assignments("--set", changes, "exosuit.length=8 cm"))
