"""What notebooks show."""

from __future__ import annotations

from html.parser import HTMLParser

import pytest

import flexor
from flexor.materials.library import find
from flexor.model import Model, load, parse
from flexor.notebook import html

HOSTILE = """
name = "bar"
title = "<script>alert(1)</script>"
planar = true

[bodies.bar]
kind = "link"
length = "4 cm"
radius = "1 cm"
joint = { kind = "revolute", stiffness = "0.04 N*m/rad" }
"""


class Reader(HTMLParser):
    """Checks that tags are closed, and collects the texts of cells."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: set[str] = set()
        self.texts: list[str] = []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        if tag != "img":
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


def read(shown: object) -> Reader:
    return Reader(shown._repr_html_())  # type: ignore[attr-defined]


def test_a_model_is_shown_with_its_bodies() -> None:
    found = read(load("finger"))
    assert {"img", "table"} <= found.tags
    assert {"finger", "ph_1", "exosuit", "rod", "revolute"} <= set(found.texts)


def test_a_path_is_shown_step_by_step() -> None:
    path = load("finger").equilibrium([0.0, 2.0])
    found = read(path)
    assert "img" in found.tags
    assert {"0", "2", "stable"} <= set(found.texts)
    assert f"{path.joint_angles[1, 0] * 180.0 / 3.141592653589793:.2f}" in found.texts


def test_a_long_path_is_shortened() -> None:
    found = read(load("finger").equilibrium("0:2:0.05"))
    assert "⋮" in found.texts
    assert len([text for text in found.texts if text == "stable"]) == 24


def test_a_study_and_a_landscape() -> None:
    study = flexor.optimize(load("finger"), "R01", budget=12, seed=1)
    found = read(study)
    assert {"R_0 / cm", "start", "best"} <= set(found.texts)
    shown = read(flexor.landscape(load("finger"), "R01", grid=3))
    assert "img" in shown.tags
    assert any("9 designs" in text for text in shown.texts)


def test_a_material_is_shown_with_its_source() -> None:
    found = read(find("dragon-skin-30"))
    assert "img" in found.tags
    assert "ogden" in found.texts
    assert any("doi" in text for text in found.texts)


def test_texts_from_files_are_escaped() -> None:
    found = read(Model(parse(HOSTILE)))
    assert "script" not in found.tags
    assert any("<script>" in text for text in found.texts)


def test_pictures_are_images_that_run_nothing() -> None:
    text = load("finger")._repr_html_()
    assert "data:image/svg+xml;base64," in text
    assert "<svg" not in text


def test_other_objects_have_none() -> None:
    with pytest.raises(TypeError, match="int has no representation"):
        html(1)
