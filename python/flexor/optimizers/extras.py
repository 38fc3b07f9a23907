"""Methods whose libraries are extras: whether they are there, and how to get them."""

from __future__ import annotations

from importlib.util import find_spec

from flexor.errors import InputError
from flexor.installing import install_command

# Method: module, package.
EXTRAS = {"mads": ("PyNomad", "PyNomadBBO"), "surrogate": ("egobox", "egobox")}


def missing(method: str) -> str | None:
    """Return the package that a method needs and is not installed, or None."""
    module, package = EXTRAS.get(method, ("", ""))
    return package if module and find_spec(module) is None else None


def need(method: str) -> None:
    """Refuse a method whose library is not installed.

    Raises
    ------
    InputError
        With the command that installs it.
    """
    package = missing(method)
    if package is not None:
        raise InputError(
            f'method "{method}" needs the package {package}, which is not installed: '
            f"{install_command(package)}."
        )
