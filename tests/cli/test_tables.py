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


@pytest.mark.parametrize("count", [3, 5, 8, 13])
def test_headings_are_wrapped_and_never_cut(printed: io.StringIO, count: int) -> None:
    """Every word of a heading is there, whatever the numbers below it."""
    headings = [f"contact pressure of cushion_{i} / kPa" for i in range(count)]
    table.show(("force / N", *headings, "state"), [("1", *["0.123"] * count, "stable")] * 2)
    assert max(map(len, printed.getvalue().splitlines())) <= 80
    words = printed.getvalue().split()
    for i in range(count):
        assert words.count(f"cushion_{i}") == 1
    assert words.count("contact") == words.count("pressure") == words.count("kPa") == count


def test_long_names_are_broken_at_their_dots(printed: io.StringIO) -> None:
    """Not in the middle of a word."""
    name = "bodies.exosuit.section.layer.thickness"
    table.show(("", *[f"{name} / mm"] * 4), [("start", *["0.5"] * 4)])
    lines = printed.getvalue().splitlines()
    assert max(map(len, lines)) <= 80
    assert printed.getvalue().split().count("bodies.exosuit.section.") == 4


def test_texts_are_aligned_to_the_left(printed: io.StringIO) -> None:
    """Numbers, with their units, to the right."""
    table.show(("", "worst", "where"), [("a", "0.7", "here"), ("b", "1.2 mm", "over there")])
    first, second = printed.getvalue().splitlines()[3:5]
    assert first.index("here") == second.index("over")
    assert first.index("0.7") + 3 == second.index("1.2 mm") + 6


def test_what_is_less_than_it_is_known_to_is_no_number() -> None:
    assert table.numbers([5e-15, 2.0, -1e-10, float("nan")], [1e-9] * 4) == ["0", "2", "0", "nan"]
    assert table.numbers([4e-10, 1e9], [1e-12, 1e-12]) == ["4e-10", "1e+09"]
    assert table.stated([5e-15, 2.0, 1e-9]) == ["0", "2", "1e-09"]
