"""Versions and system, as far as results depend on them to the last bit."""

from __future__ import annotations

import hashlib
import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

_PACKAGES = ("numpy", "scipy", "pymoo", "cma", "PyNomadBBO", "egobox")
# Resuming and remote workers require the same builds, resuming also the same minor versions.
DECISIVE = ("engine_path", "engine")
MINOR = ("python", "numpy")


@cache
def environment() -> dict[str, str]:
    """Return versions and machine, with the packages that compute.

    ``engine_path`` is which build of the engine (see `flexor._dispatch`), ``engine`` the first
    digits of its SHA-256, which distinguishes builds of one version.
    """
    from flexor import _engine
    from flexor._dispatch import engine_path

    library = Path(str(_engine.__file__)).read_bytes()
    return {
        "engine": hashlib.sha256(library).hexdigest()[:16],
        "engine_path": engine_path(),
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.machine()}",
        **{name: installed(name) for name in _PACKAGES},
    }


def decisive_versions() -> dict[str, str]:
    """Return what must be the same for the same bits: the version of Flexor and its engine."""
    here = environment()
    return {"flexor": installed("flexor"), **{key: here[key] for key in DECISIVE}}


def installed(package: str) -> str:
    """Return the version of a package, ``"unknown"`` if it is not installed as one."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"
