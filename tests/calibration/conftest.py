from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

import flexor as package
from flexor.cli.app import main
from flexor.model import Model

E = """
[[constant]]
name = "E"
fields = ["exosuit.young_modulus"]
range = ["500 kPa", "8 MPa"]
scale = "log"
"""
ANGLE = """
[[target]]
name = "bend"
observable = "bending"
force = "0:4:2"
value = "0.5 rad"
tolerance = "0.01 rad"
"""


@dataclass(frozen=True)
class Outcome:
    """What a run of the command line printed, and how it ended."""

    code: int
    out: str
    err: str


@pytest.fixture(scope="session")
def coarse() -> Model:
    """The paper's finger with a third of its elements: the same physics, quickly."""
    return package.load(
        "finger", "calibrated", changes={"exosuit.elements": 4, "exosuit.gauss_points": 2}
    )


@pytest.fixture
def targets(tmp_path) -> Callable[..., Path]:
    """Return a function that writes a targets file; E and ANGLE unless told otherwise."""

    def write(*parts: str, name: str = "made-targets.toml") -> Path:
        path = tmp_path / name
        path.write_text("\n".join(parts or (E, ANGLE)), encoding="utf-8")
        return path

    return write


@pytest.fixture
def flexor(capsys, monkeypatch, tmp_path) -> Callable[..., Outcome]:
    """Return a function that runs `flexor` in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")
    monkeypatch.setenv("NO_COLOR", "1")

    def run(*arguments: object) -> Outcome:
        with pytest.raises(SystemExit) as ended:
            main([str(argument) for argument in arguments])
        said = capsys.readouterr()
        return Outcome(int(ended.value.code or 0), said.out, said.err)

    return run
