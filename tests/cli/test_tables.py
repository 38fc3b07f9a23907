"""Tables in a terminal of 80 columns."""

from __future__ import annotations

import io

import pytest

from flexor.cli import table
from flexor.cli.console import _PlainConsole


@pytest.fixture
def printed(monkeypatch: pytest.MonkeyPatch) -> io.StringIO:
    """Return what is printed to a terminal of 80 columns."""
    text = io.StringIO()
    monkeypatch.setattr(table, "out", _PlainConsole(file=text, width=80, highlight=False))
    return text


def test_columns_that_do_not_fit_go_below(printed: io.StringIO) -> None:
    """Every cell is there once, and the first column with each part."""
    headings = ["force / N", *(f"joint_{i} / °" for i in range(30))]
    rows = [[f"{row}.5", *(f"{100 * row + i}.25" for i in range(30))] for row in range(1, 4)]
    table.show(headings, rows, left=0)
    lines = printed.getvalue().splitlines()
    assert max(map(len, lines)) <= 80
    words = printed.getvalue().split()
    for row in rows:
        assert all(words.count(cell) == 1 for cell in row[1:])
        assert words.count(row[0]) == words.count("force") > 1


def test_a_table_that_fits_is_one(printed: io.StringIO) -> None:
    """As before."""
    table.show(("", "start", "optimum"), [("exosuit.section.wall / mm", "2", "1.5")])
    assert printed.getvalue().count("start") == 1


def test_names_of_any_length_fit(printed: io.StringIO) -> None:
    """Long labels are wrapped, numbers are not."""
    names = [f"bodies.exosuit.section.part_{i}.thickness.at_the_base" for i in range(12)]
    table.show(
        ("", *("tip force / N", "bending / deg") * 3), [(n, *["-123.4567"] * 6) for n in names]
    )
    lines = printed.getvalue().splitlines()
    assert max(map(len, lines)) <= 80
    assert printed.getvalue().count("-123.4567") == 72
