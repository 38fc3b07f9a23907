"""The command that installs a package where Flexor runs."""

from __future__ import annotations

import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

__all__ = ["install_command"]


def install_command(package: str) -> str:
    """Return what to type to install a package into the environment of this process.

    Parameters
    ----------
    package
        Such as ``"egobox"`` or ``"flexor[validate]"``.

    Returns
    -------
    str
        With pip where the environment has it, else with uv, which environments made by uv (that of
        `./dev setup` too) are filled with.
    """
    if find_spec("pip") is not None:
        words = ["pip", "install"]
        beside = Path(sys.executable).parent
        if shutil.which("pip", path=str(beside)) != shutil.which("pip"):  # another environment's
            words = [_short(sys.executable), "-m", *words]
    else:
        words = [_short(next(_uvs(), "uv")), "pip", "install", "--python", _short(sys.executable)]
    words.append(package)
    return subprocess.list2cmdline(words) if sys.platform == "win32" else _quoted(words)


def _uvs() -> Iterator[str]:
    """Where uv is: on the path, or in the checkout whose `.venv` this is."""
    if shutil.which("uv"):
        yield "uv"
    for name in ("uv", "uv.exe"):
        yield from map(str, sorted(Path(sys.prefix).parent.glob(f".tools/uv-*/bin/{name}")))


def _short(path: str) -> str:
    """Return a path relative to the current folder if it is inside it."""
    try:
        return str(Path(path).relative_to(Path.cwd()))
    except ValueError:
        return path


def _quoted(words: list[str]) -> str:
    # Brackets are patterns to some shells; double quotes read better than shlex's.
    return " ".join(f'"{word}"' if "[" in word else shlex.quote(word) for word in words)
