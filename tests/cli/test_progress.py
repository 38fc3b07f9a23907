"""What is said of work that takes a while, where output is no terminal."""

from __future__ import annotations

import time

import pytest

from flexor.cli import progress


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    lines: list[str] = []
    monkeypatch.setattr(progress, "note", lines.append)
    monkeypatch.setattr(progress, "NOTE_AFTER", 0.05)
    return lines


def test_parts_that_take_long_are_named(said: list[str]) -> None:
    with progress.working("checking") as say:
        say("constraints")
        say("twice the elements")
        time.sleep(0.3)
        say("warnings")
    time.sleep(0.1)
    assert said == ["checking …", "  twice the elements …"]


def test_work_is_named_once_it_takes_long(said: list[str]) -> None:
    for seconds in (0.0, 0.3):
        with progress.working("drawing", at_once=False):
            time.sleep(seconds)
    time.sleep(0.1)
    assert said == ["drawing …"]
