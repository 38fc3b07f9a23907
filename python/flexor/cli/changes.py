"""Loading models with fields overridden on the command line."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexor.cli.values import assignments

if TYPE_CHECKING:
    from flexor.model import Model


def load_changed(model: str, constants: str | None, changes: list[str]) -> Model:
    """Load a model with some fields overridden.

    Parameters
    ----------
    model : str
        Model file or preset.
    constants : str or None
        Set of constants to use instead of the file's own choice.
    changes : list of str
        Overrides, such as `["exosuit.length=8 cm"]`.

    Returns
    -------
    Model
        The modified model.

    Raises
    ------
    InputError
        If the model or a field does not exist, or a value is invalid.
    """
    from flexor.model import load

    return load(model, constants, assignments("--set", changes, "exosuit.length=8 cm"))
