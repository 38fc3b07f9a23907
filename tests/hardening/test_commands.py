"""Commands given by a clumsy hand."""

from __future__ import annotations

import io

import pytest

from flexor.cli import progress
from flexor.cli.app import main
from flexor.errors import InputError
from flexor.store import Database
from flexor.study.comparison.record import COMPARISON, finished


def run(*arguments: str) -> int:
    with pytest.raises(SystemExit) as ended:
        main(list(arguments))
    return int(ended.value.code or 0)


@pytest.mark.parametrize(
    "again", [("-o", "bending"), ("--objective", "tip-force"), ("-o=bending",)]
)
def test_repeated_options_are_refused(
    capsys: pytest.CaptureFixture[str], again: tuple[str]
) -> None:
    assert run("optimize", "finger", "-o", "bending", *again) == 2
    assert "--objective is given twice" in capsys.readouterr().err


def test_searches_tell_where_they_are(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(progress, "LINE_EVERY", 0.0)
    shown = io.StringIO()
    monkeypatch.setattr(progress.err, "_file", shown)  # its property would pin the stream of now
    line = progress.LiveLine()
    line.show(["best 1 [red]rad", "5 designs"], 5, 10, "1 s left")
    assert shown.getvalue() == "best 1 [red]rad · 5 designs · 1 s left\n"


@pytest.mark.parametrize("key", ['[["L"], "pattern-search", 0]', '["L", "x"]', '["L", "x", 1e400]'])
def test_damaged_names_of_searches(key: str) -> None:
    database = Database(None, COMPARISON.tables)
    database.write(("INSERT INTO searches VALUES (?, ?)", [(key, "{}")]))
    with pytest.raises(InputError, match="a finished search is damaged"):
        finished(database)
