from __future__ import annotations

import csv
import io
import math

import pytest

from flexor.paper.page import page
from flexor.paper.section import Column, Compared, Section, Table, number
from flexor.paper.symbols import marked
from flexor.paper.table_file import as_csv

TABLE = Table(
    name="t",
    caption="A <caption>.",
    columns=(
        Column("name"),
        Column("length", "cm", 3),
        Column("good"),
        Column("time", "s", 2, timing=True),
    ),
    rows=(("a, b", 1.0 / 3.0, True, 1.5), ("c", None, False, math.nan)),
)


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.0, "0"),
        (-1e-15, "0"),
        (1.43, "1.43"),
        (14.000000000000002, "14"),
        (-0.24776, "-0.2478"),
        (2228.5, "2228"),
        (1500000.0, "1.5e+06"),
        (0.00002, "2e-05"),
        (math.inf, "∞"),
        (math.nan, "–"),
    ],
)
def test_numbers_as_people_read_them(value: float, shown: str) -> None:
    assert number(value) == shown


def test_differences_are_ours_minus_published() -> None:
    each = Compared("angle", "Fig. 3", 1.05, 1.02, "rad")
    assert each.difference == pytest.approx(-0.03)
    assert each.percent == pytest.approx(-100 * 0.03 / 1.05)
    assert Compared("wave", "Table III", 0.0, 1.0).percent is None
    assert Compared("wave", "Table III", -2.0, -1.0).percent == pytest.approx(50.0)


def test_csv_reads_back_with_every_digit() -> None:
    rows = list(csv.reader(io.StringIO(as_csv(TABLE))))
    assert rows[0] == ["name", "length [cm]", "good", "time [s]"]
    assert rows[1] == ["a, b", repr(1.0 / 3.0), "yes", "1.5"]
    assert rows[2] == ["c", "", "no", ""]


def test_symbols_get_their_subscripts_and_text_is_escaped() -> None:
    assert marked("f_b < R_0") == "<i>f</i><sub>b</sub> &lt; <i>R</i><sub>0</sub>"
    assert marked("phi_A") == "<i>φ</i><sub>A</sub>"
    assert marked("ph_1 and half_b") == "ph_1 and half_b"


def test_page_escapes_marks_and_times() -> None:
    section = Section("s", "Title", ("Text & more.",), tables=(TABLE,))
    html = page([section], {}, {"seed": "0"}, "3 s", "Lead.")
    assert "Text &amp; more." in html
    assert "A &lt;caption&gt;." in html
    assert '<span class="yes">yes</span>' in html
    assert '<span class="time">1.5</span>' in html
    assert '<td class="number">0.333</td>' in html
