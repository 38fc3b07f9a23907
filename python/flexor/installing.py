"""The command that installs a package into the current environment."""

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
    """Return the shell command that installs a package into the current environment.

    It uses pip if the environment has it, else uv, as in the environment of `./dev setup`.
    """
    if find_spec("pip") is not None:
        words = ["pip", "install"]
        beside = Path(sys.executable).parent
        if shutil.which("pip", path=str(beside)) != shutil.which("pip"):  # another environment's
            words = [_relative(sys.executable), "-m", *words]
    else:
        uv, python = next(_uvs(), "uv"), sys.executable
        words = [_relative(uv), "pip", "install", "--python", _relative(python)]
    words.append(package)
    return subprocess.list2cmdline(words) if sys.platform == "win32" else _quoted(words)


def _uvs() -> Iterator[str]:
    """Yield locations of uv: on the path, or in the checkout that contains this environment."""
    if shutil.which("uv"):
        yield "uv"
    for name in ("uv", "uv.exe"):
        yield from map(str, sorted(Path(sys.prefix).parent.glob(f".tools/uv-*/bin/{name}")))


def _relative(path: str) -> str:
    """Return a path relative to the current folder if it is inside it."""
    try:
        return str(Path(path).relative_to(Path.cwd()))
    except ValueError:
        return path


def _quoted(words: list[str]) -> str:
    # Some shells expand brackets; double quotes are also valid on Windows.
    return " ".join(f'"{word}"' if "[" in word else shlex.quote(word) for word in words)
