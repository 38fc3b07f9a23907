"""What a study was made with, as far as it may decide the last bits of its numbers."""

from __future__ import annotations

import hashlib
import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

_PACKAGES = ("numpy", "scipy", "pymoo", "cma")


@cache
def environment() -> dict[str, str]:
    """Versions and machine.

    Returns
    -------
    dict of str
        ``engine``, the first digits of the SHA-256 of the compiled engine, which tells builds of
        one version apart; ``engine_path``, which of its builds (see `flexor._dispatch`);
        ``python``, ``system`` (with the kind of processor), and the packages that compute.
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


def installed(package: str) -> str:
    """Return the version of a package.

    Parameters
    ----------
    package
        Its name.

    Returns
    -------
    str
        ``"unknown"`` if it is not installed as one.
    """
    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"
