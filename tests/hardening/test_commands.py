"""Commands given by a clumsy hand."""

from __future__ import annotations

import io
import sqlite3
from pathlib import Path

import pytest

from flexor.cli import progress
from flexor.cli.app import main
from flexor.errors import InputError
from flexor.model import load
from flexor.store import Database
from flexor.study import optimize, resume
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


@pytest.mark.parametrize("value", ["1e400", "NaN", "-Infinity", '"a"', "[]"])
@pytest.mark.parametrize("field", ["value", "seconds", "improvement_values"])
def test_damaged_values_of_searches(field: str, value: str) -> None:
    sound = {
        "seconds": "1.0",
        "value": "-1.0",
        "evaluations": "2",
        "iterations": "1",
        "reason": '"done"',
        "design": "[0.1]",
        "improvement_evaluations": "[1]",
        "improvement_values": "[-1.0]",
        "improvement_designs": "[0.1]",
    }

    def database(values: dict[str, str]) -> Database:
        text = ", ".join(f'"{key}": {each}' for key, each in values.items())
        made = Database(None, COMPARISON.tables)
        made.write(("INSERT INTO searches VALUES (?, ?)", [('["L", "ps", 0]', f"{{{text}}}")]))
        return made

    assert len(finished(database(sound))) == 1
    if (field, value) == ("improvement_values", "[]"):
        return  # a search without an improvement
    wrong = f"[{value}]" if field == "improvement_values" else value
    with pytest.raises(InputError, match="a finished search is damaged"):
        finished(database({**sound, field: wrong}))


@pytest.mark.parametrize("value", ["'a'", "9e999", "-9e999", "x'00'"])
def test_damaged_values_of_designs(tmp_path: Path, value: str) -> None:
    study = optimize(load("finger"), "L", budget=4, folder=tmp_path / "s")
    study.close()
    with sqlite3.connect(tmp_path / "s" / "record.sqlite") as record:
        record.execute(f"UPDATE evaluations SET value = {value} WHERE id = 2")
    record.close()
    with pytest.raises(InputError, match="a value is not finite"):
        resume(tmp_path / "s", budget=6)
