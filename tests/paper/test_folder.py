from __future__ import annotations

import json

import pytest

from flexor.errors import InputError
from flexor.paper.folder import STAMP, Folder

PLAIN = {"settings": {}, "provenance": {}, "items": []}


@pytest.fixture
def folder(tmp_path) -> Folder:
    return Folder.create(tmp_path / "out", PLAIN)


def test_a_part_is_computed_once_and_read_back_exactly(folder) -> None:
    calls = []

    def compute() -> dict:
        calls.append(1)
        return {"third": 1.0 / 3.0, "list": [1, 2.5e-300]}

    first = folder.part("p", compute)
    again = Folder.resume(folder.path).part("p", compute)
    assert len(calls) == 1
    assert first == again
    assert again.data["third"] == 1.0 / 3.0
    assert first.seconds >= 0.0
    assert folder.processor() >= 0.0


def test_a_part_that_died_leaves_nothing_behind(folder) -> None:
    def die() -> dict:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        folder.part("p", die)
    assert folder.part("p", lambda: {"a": 1}).data == {"a": 1}


def test_a_draft_that_was_cut_off_is_not_taken_for_a_part(folder) -> None:
    parts = folder.path / "parts"
    parts.mkdir()
    (parts / ".p.json.new").write_text('{"seconds": 1.0, "da', encoding="utf-8")
    assert folder.part("p", lambda: {"a": 1}).data == {"a": 1}
    assert not (parts / ".p.json.new").exists()


@pytest.mark.parametrize("text", ["{", "[]", '{"data": {}}'])
def test_a_damaged_part_is_named(folder, text: str) -> None:
    (folder.path / "parts").mkdir()
    (folder.path / "parts" / "p.json").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"p\.json\" is damaged: delete it"):
        folder.part("p", dict)


def test_items_add_up(folder) -> None:
    assert folder.ask_for(["fig4"]) == ("fig4",)
    assert Folder.resume(folder.path).ask_for(["fig3", "fig4"]) == ("fig4", "fig3")
    assert json.loads((folder.path / STAMP).read_text())["items"] == ["fig4", "fig3"]


def test_places_that_cannot_be_used(tmp_path, folder) -> None:
    with pytest.raises(InputError, match="holds a reproduction already: go on with --resume"):
        Folder.create(folder.path, PLAIN)
    with pytest.raises(InputError, match="is not an empty folder"):
        Folder.create(tmp_path, PLAIN)
    with pytest.raises(InputError, match="there is no such folder"):
        Folder.resume(tmp_path / "nowhere")
    with pytest.raises(InputError, match=f"it has no {STAMP}"):
        Folder.resume(tmp_path)
    (folder.path / STAMP).write_text('{"format": 99}')
    with pytest.raises(InputError, match="reads format 1"):
        Folder.resume(folder.path)
    (folder.path / STAMP).write_text('{"format": 1}')
    with pytest.raises(InputError, match="is damaged"):
        Folder.resume(folder.path)
