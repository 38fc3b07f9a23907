"""The packages of the extras `make` and `step`, imported where they are needed."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from flexor.errors import InputError
from flexor.installing import install_command

MAKE, STEP = "flexor[make]", "flexor[step]"


def required(name: str, extra: str = MAKE) -> Any:
    """Import a package of an extra.

    Parameters
    ----------
    name
        Of the module.
    extra
        The extra.

    Raises
    ------
    InputError
        If it is not installed, with the command that installs the extra.
    """
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        missing = (error.name or name).partition(".")[0]
        what = "STEP files" if extra == STEP else "solids"
        raise InputError(
            f"{what} need the package {missing}, which is not installed: {install_command(extra)}."
        ) from None
