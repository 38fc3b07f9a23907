"""Optional dependencies of the search methods."""

from __future__ import annotations

from importlib.util import find_spec

from flexor.errors import InputError
from flexor.installing import install_command

# Method: module, package.
EXTRAS = {"mads": ("PyNomad", "PyNomadBBO"), "surrogate": ("egobox", "egobox")}


def missing_package(method: str) -> str | None:
    """Return the package that a method needs and that is not installed, or None."""
    module, package = EXTRAS.get(method, ("", ""))
    return package if module and find_spec(module) is None else None


def require_installed(method: str) -> None:
    """Raise an error if the library of a method is not installed."""
    package = missing_package(method)
    if package is not None:
        raise InputError(
            f'method "{method}" needs the package {package}, which is not installed: '
            f"{install_command(package)}."
        )
