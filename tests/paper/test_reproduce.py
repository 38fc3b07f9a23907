"""The study as a whole, with settings so small that only its form can be tested."""

from __future__ import annotations

import csv
import re
from html.parser import HTMLParser

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.paper import ITEMS, published, reproduce
from flexor.paper.items import chosen
from flexor.paper.optimum import as_legendre

from .timeless import timeless


class Reader(HTMLParser):
    """Collects what a page refers to, and whether its elements are closed in order."""

    VOID = ("meta", "img", "br", "link", "input")

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.sources: list[str] = []
        self.links: list[str] = []
        self.names: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in self.VOID:
            self.open.append(tag)
        given = dict(attrs)
        self.sources += [given[key] or "" for key in ("src", "srcset") if key in given]
        self.links += [given["href"] or ""] if "href" in given else []
        self.names |= {given["id"] or ""} if "id" in given else set()

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_report_is_one_sound_page_that_needs_nothing_else(whole) -> None:
    reader = Reader()
    reader.feed(whole.report.read_text(encoding="utf-8"))
    assert reader.open == []
    pictures = [picture for section in whole.sections for picture in section.pictures]
    assert len(reader.sources) == len(pictures) > 5
    assert all(source.startswith("data:image/png;base64,") for source in reader.sources)
    assert all(link.startswith("#") and link[1:] in reader.names for link in reader.links)
    assert set(ITEMS) <= reader.names


def test_every_figure_and_table_is_a_file(whole) -> None:
    for section in whole.sections:
        for picture in section.pictures:
            for ending in ("png", "svg"):
                file = whole.folder / "figures" / f"{picture.name}.{ending}"
                assert file.stat().st_size > 10_000
        for table in section.all_tables:
            file = whole.folder / "tables" / f"{table.name}.csv"
            rows = list(csv.reader(file.open(encoding="utf-8")))
            assert len(rows) == len(table.rows) + 1
            assert {len(row) for row in rows} == {len(table.columns)}


def test_every_published_number_stands_beside_ours(whole) -> None:
    compared = [each for section in whole.sections for each in section.compared]
    shown = [each.published for each in compared]
    printed = [value for row in published.TABLE_III.values() for value in row.design]
    printed += [value for row in published.TABLE_IV.values() for value in row.design]
    printed += published.GLOBAL_MINIMUM.design
    for number in (published.TWO_LINKS, published.THREE_LINKS, published.LARGEST_BENDING):
        assert number.value in shown
    for value in printed:
        # Lengths are shown in cm, coefficients as they are.
        assert any(
            theirs == pytest.approx(value) or theirs == pytest.approx(100 * value)
            for theirs in shown
            if theirs is not None
        )
    minutes = {row.minutes for row in (*published.TABLE_III.values(), *published.TABLE_IV.values())}
    (table3,) = (table for s in whole.sections for table in s.all_tables if table.name == "table3")
    (table4,) = (table for s in whole.sections for table in s.all_tables if table.name == "table4")
    assert minutes <= {cell for row in (*table3.rows, *table4.rows) for cell in row}


def test_sets_that_hold_others_are_at_least_as_good(whole) -> None:
    (table,) = (table for s in whole.sections for table in s.all_tables if table.name == "table3")
    value = {row[0]: row[1] for row in table.rows}
    for outer, inner in (
        ("L+R01", "L"), ("L+R01", "R01"), ("L+Rsc", "Rsc"), ("L+RLP", "L"), ("L+RLP", "RLP"),
    ):  # fmt: skip
        assert value[outer] <= value[inner]
    # Even searches as small as these begin at the published optimum.
    for row in table.rows[1:]:
        assert row[2] is not None
        assert row[1] <= value["default"]


def test_bending_of_fig3_is_the_models_own(whole) -> None:
    (section,) = (s for s in whole.sections if s.name == "fig3")
    for each, preset in zip(section.compared, ("finger-2-links", "finger"), strict=True):
        path = flexor.load(preset).equilibrium([0, 2, 4, 6, 8, 10])
        assert each.ours == float(path.joint_angles[-1].sum())


def test_straight_surfaces_as_legendre_coefficients() -> None:
    X = np.linspace(0.0, 1.0, 7)
    chosen_set = flexor.design.parameter_set("RLP", flexor.load("finger").design)
    radii = np.array([0.0065, 0.0074])
    geometry = chosen_set.geometry(as_legendre(radii, chosen_set.size)[None, :], X)
    np.testing.assert_allclose(geometry.radius[0], radii[0] + X * (radii[1] - radii[0]), rtol=1e-12)


def test_findings_in_markdown(whole) -> None:
    docs = whole.folder.parent / "docs"
    text = (docs / "reproduction.md").read_text(encoding="utf-8")
    for section in whole.sections:
        assert f"## {section.title}" in text
        for paragraph in section.text:
            assert paragraph in text
    images = re.findall(r"\]\((images/[^)]+)\)", text)
    assert len(images) > 5
    assert all((docs / image).stat().st_size > 1000 for image in images)
    heads = [line for line in text.splitlines() if line.startswith("|")]
    assert heads
    assert "time / s" not in text


def test_resuming_adds_items_and_keeps_those_there(tmp_path, small) -> None:
    out = tmp_path / "out"
    first = reproduce(out, "fig3", settings=small)
    assert [section.name for section in first.sections] == ["fig3"]
    part = out / "parts" / "fig3.json"
    before = part.stat().st_mtime_ns
    both = reproduce(out, ["constants"], resume=True)
    assert [section.name for section in both.sections] == ["constants", "fig3"]
    assert part.stat().st_mtime_ns == before
    page = timeless(both.report)
    again = reproduce(out, resume=True)
    assert timeless(again.report) == page


def test_items_are_found_in_any_spelling() -> None:
    assert chosen("TABLE3, Fig. 4") == ("fig4", "table3")
    assert chosen(None) == tuple(ITEMS)
    with pytest.raises(InputError, match='unknown item of the study "figg4"'):
        chosen("figg4")
    with pytest.raises(InputError, match="no item of the study is named"):
        chosen(" , ")
