"""Where the numbers of a report come from."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

from flexor.model import load
from flexor.paper.context import ALONE, FINGER, TWO_LINKS
from flexor.paper.settings import Settings

# What decides the numbers besides Flexor: the libraries that search.
LIBRARIES = ("numpy", "scipy", "pymoo", "cma", "PyNomadBBO")


def provenance(settings: Settings) -> dict[str, str]:
    """Describe what the numbers come from.

    Parameters
    ----------
    settings : Settings
        Of the reproduction.

    Returns
    -------
    dict of str
        Version, command, constants, seed, hashes of the models and versions of the libraries.
    """
    hashes = {
        f"model {name}": load(name, constants=settings.constants).hash
        for name in (FINGER, TWO_LINKS, ALONE)
    }
    libraries = ", ".join(f"{name} {found}" for name in LIBRARIES if (found := _version(name)))
    return {
        "flexor": version("flexor"),
        "command": command(settings),
        "constants": settings.constants,
        "seed": str(settings.seed),
        **hashes,
        "libraries": f"Python {platform.python_version()}, {libraries}",
    }


def _version(library: str) -> str:
    try:
        return version(library)
    except PackageNotFoundError:
        return ""


def command(settings: Settings) -> str:
    """Return the command that makes a report with these settings."""
    return f"flexor reproduce --constants {settings.constants} --seed {settings.seed}"
