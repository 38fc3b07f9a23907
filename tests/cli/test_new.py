"""`flexor new` and what leads to it: presets shown, names completed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from flexor.model import load, presets


def test_a_new_file_is_the_preset_under_another_name(flexor, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    ran = flexor("new", "mine")
    assert ran.code == 0
    assert "flexor simulate mine.toml" in ran.out
    model, preset = load("mine.toml"), load("pneumatic-finger")
    assert model.name == "mine"
    assert model.file.model_copy(update={"name": preset.name}) == preset.file


@pytest.mark.parametrize("name", presets())
def test_every_preset_can_be_copied(flexor, tmp_path: Path, monkeypatch, name: str) -> None:
    monkeypatch.chdir(tmp_path)
    assert flexor("new", "mine.toml", "--from", name).code == 0
    assert load("mine.toml").name == "mine"


def test_nothing_is_overwritten(flexor, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("mine.toml").write_text("kept")
    ran = flexor("new", "mine")
    assert ran.code == 2
    assert '"mine.toml" exists already' in ran.error
    assert Path("mine.toml").read_text() == "kept"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["mine", "--from", "fingr"], 'did you mean "finger"'),
        (["my finger"], "letters, digits"),
        (["../mine"], ""),
        (["no/such/folder/mine"], "no such file or directory"),
    ],
)
def test_bad_input(flexor, tmp_path: Path, monkeypatch, arguments: list[str], words: str) -> None:
    inner = tmp_path / "inner"
    inner.mkdir()
    monkeypatch.chdir(inner)
    ran = flexor("new", *arguments)
    if words:
        assert ran.code == 2
        assert words in ran.error.lower()
    else:
        assert ran.code == 0  # a path is as good as a name


def test_a_preset_is_shown_as_it_is(flexor) -> None:
    ran = flexor("presets", "finger")
    assert ran.code == 0
    assert 'name = "finger"' in ran.out
    assert flexor("presets", "fingr").code == 2


@pytest.mark.skipif(os.name == "nt", reason="completion of a POSIX shell")
def test_names_of_presets_are_completed() -> None:
    words = {"COMP_WORDS": "flexor simulate fin", "COMP_CWORD": "2"}
    script = [sys.executable, "-c", "from flexor.cli.app import main; main()"]
    asked = {**os.environ, **words, "_FLEXOR_COMPLETE": "complete_bash"}
    ran = subprocess.run(script, env=asked, capture_output=True, text=True, check=False)
    assert ran.stdout.split() == ["finger", "finger-2-links", "finger-two-chambers"]
