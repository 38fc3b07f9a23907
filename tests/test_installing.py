"""Installation commands in messages work in the current environment."""

from __future__ import annotations

import shlex
import subprocess
import sys

import pytest

from flexor import installing
from flexor.installing import install_command


@pytest.mark.skipif(sys.platform == "win32", reason="quotes as a POSIX shell does")
def test_the_command_works_in_this_environment() -> None:
    words = shlex.split(install_command("numpy[any]"))
    assert words[-1] == "numpy[any]"
    # Installed packages are found without a network.
    done = subprocess.run([*words[:-1], "--dry-run", "numpy"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert sys.prefix in done.stdout + done.stderr or "uv" in words[0]


def test_with_pip(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(installing, "find_spec", lambda module: object())
    monkeypatch.setattr(installing.shutil, "which", lambda name, path=None: "/env/bin/pip")
    assert install_command("egobox") == "pip install egobox"
    assert install_command("flexor[validate]") == 'pip install "flexor[validate]"'


def test_with_the_pip_of_another_environment_on_the_path(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(installing, "find_spec", lambda module: object())
    monkeypatch.setattr(installing.shutil, "which", lambda name, path=None: path and f"{path}/pip")
    assert install_command("egobox").endswith(" -m pip install egobox")


def test_without_pip(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(installing, "find_spec", lambda module: None)
    monkeypatch.setattr(installing, "_uvs", lambda: iter(["uv"]))
    monkeypatch.setattr(installing.sys, "executable", "/a place/bin/python")
    assert install_command("egobox") == "uv pip install --python '/a place/bin/python' egobox"
