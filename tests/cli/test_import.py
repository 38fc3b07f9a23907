"""`flexor import`, and `flexor export --mjcf`."""

from __future__ import annotations

from pathlib import Path

from flexor.exchange import read_limb
from flexor.model import load

REFERENCE = Path(__file__).parents[1] / "reference" / "limb.xml"


def test_there_and_back(flexor) -> None:
    said = flexor("import", str(REFERENCE), "--out", "limb.toml")
    assert said.code == 0
    assert "contains:  4 bodies, 7 joints, 3 tendons" in said.out
    assert "left out:  damping of joints, 5 times" in said.out
    assert load("limb.toml").tendons == ("extensor", "flexor", "lumbrical")
    said = flexor("export", "limb.toml", "--mjcf", "again.xml")
    assert said.code == 0
    assert "left out:  toes of springs" in said.out
    assert read_limb("again.xml").tendons[0].muscle is not None


def test_files_that_cannot_be_written(flexor) -> None:
    assert "must end in .toml" in flexor("import", str(REFERENCE), "--out", "limb.xml").error
    Path("limb.toml").write_text("mine")
    error = flexor("import", str(REFERENCE), "--out", "limb.toml").error
    assert "add --force to overwrite it" in error
    assert Path("limb.toml").read_text() == "mine"
    assert "its name must end in .xml" in flexor("export", "finger", "--mjcf", "f.toml").error


def test_a_file_that_is_refused(flexor) -> None:
    Path("hand.xml").write_text("<mujoco><worldbody><body><hand/></body></worldbody></mujoco>")
    error = flexor("import", "hand.xml", "--out", "hand.toml").error
    assert error.startswith("error: hand.xml, line 1: <hand> is not an element of a body")
    assert not Path("hand.toml").exists()
