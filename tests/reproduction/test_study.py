"""Results are cached, and a folder is never resumed with other settings."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest

from flexor.errors import InputError
from reproduction.study import QUICK, Effort, Study


@pytest.fixture
def study(tmp_path) -> Study:
    return Study(tmp_path / "out", QUICK)


def test_a_result_is_computed_once_and_read_back_exactly(study) -> None:
    calls = []

    def compute() -> dict:
        calls.append(1)
        return {"third": 1.0 / 3.0, "list": [1, 2.5e-300]}

    first = study.cached("r", compute)
    again = Study(study.folder, QUICK).cached("r", compute)
    assert len(calls) == 1
    assert first == again
    assert again["third"] == 1.0 / 3.0


def test_an_interrupted_result_leaves_nothing_behind(study) -> None:
    def interrupted() -> dict:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        study.cached("r", interrupted)
    results = study.folder / "results"
    results.mkdir(exist_ok=True)
    (results / ".s.json.new").write_text('{"seconds": 1.0, "da', encoding="utf-8")
    for name in ("r", "s"):
        assert study.cached(name, lambda: {"a": 1})["a"] == 1


@pytest.mark.parametrize("text", ["{", "[]"])
def test_a_damaged_result_is_named(study, text: str) -> None:
    (study.folder / "results").mkdir()
    (study.folder / "results" / "r.json").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"r\.json\" is damaged: delete it"):
        study.cached("r", dict)


def test_other_settings_and_models_are_refused(study) -> None:
    with pytest.raises(InputError, match="were made with grid = 5, not 81"):
        Study(study.folder, Effort())
    with pytest.raises(InputError, match="were made with seed = 0, not 1"):
        Study(study.folder, QUICK, seed=1)
    stamp = study.folder / "settings.json"
    values = json.loads(stamp.read_text())
    stamp.write_text(json.dumps({**values, "model finger": "another"}))
    with pytest.raises(InputError, match="were made with model finger = another, not"):
        Study(study.folder, QUICK)


def test_a_folder_of_something_else_is_refused(tmp_path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="is not an empty folder"):
        Study(tmp_path)
    with pytest.raises(InputError, match="is not an empty folder"):
        Study(tmp_path / "file")


@pytest.mark.skipif(sys.platform == "win32", reason="links and pipes of POSIX")
@pytest.mark.parametrize("what", ["settings.json", "results", "results/a.json", "studies"])
@pytest.mark.parametrize("special", ["link", "pipe"])
def test_links_and_pipes_in_its_folder_are_not_followed(
    tmp_path: Path, what: str, special: str
) -> None:
    folder, outside = tmp_path / "s", tmp_path / "outside"
    Study(folder, QUICK).cached("a", lambda: {"x": 1})
    (folder / "studies").mkdir()
    there = outside / "precious" if what.endswith(".json") else outside
    outside.mkdir()
    (outside / "precious").write_text("{}")
    place = folder / what
    place.rename(tmp_path / "aside")
    if special == "link":
        place.symlink_to(there)
    else:
        os.mkfifo(place)
    with pytest.raises(InputError, match=r"is used in its place|is not a regular file"):
        study = Study(folder, QUICK)
        study.cached("a", lambda: {"x": 2})
        study.subfolder("b")
    assert [path.name for path in outside.iterdir()] == ["precious"]
    assert (outside / "precious").read_text() == "{}"
