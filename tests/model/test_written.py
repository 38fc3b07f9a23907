"""Model files keep the words of their authors when values change."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import flexor
from flexor.design import variables
from flexor.design.choices import combinations
from flexor.model.loading import changed_model, locate
from flexor.model.reading import parse
from flexor.study import Problem
from flexor.study.designed_model import designed_model

TEXT = """# A rod by its author.
name = "own"   # short
gravity = { z = "-9.81 m/s^2" } # down

[bodies.rod] # the only one
kind = "rod"
length = "10 cm"      # measured
radius = { tip = "4 mm", base = "0.5 cm" } # tip first
material = "soft"
strain.bend_y = "nodal_linear"
elements = 4
gauss_points = 2

[materials]
soft = { kind = "linear", young_modulus = "1 MPa", density = "1.0e3 kg/m^3" }
"""


@pytest.mark.parametrize("name", flexor.model.presets())
def test_a_preset_is_written_as_it_is(name: str) -> None:
    """To the letter."""
    text = locate(name).read_text(encoding="utf-8")
    model = flexor.load(name)
    if "[parts." in text:  # one file in place of several
        assert parse(model.to_toml()) == model.file
    else:
        assert model.to_toml() == text


def test_only_the_numbers_of_a_design_change(tmp_path: Path) -> None:
    """To all digits, in the units of the file, with every comment."""
    model = flexor.load("pneumatic-finger")
    stated = model.file.design
    assert stated is not None
    bounds = {each.field: each.bounds for each in stated.variable}
    problem = Problem.of(model, bounds, "maximise range-of-motion")
    chosen = problem.parameters
    share = np.random.default_rng(3).random(chosen.size)
    vector = chosen.lower + share * (chosen.upper - chosen.lower)
    text = designed_model(problem, vector).to_toml()
    before, after = model.to_toml().splitlines(), text.splitlines()
    changed = [line.split(" = ")[0] for line, now in zip(before, after, strict=True) if line != now]
    assert changed == ["length", "radius", "section", "proximal", "middle", "distal"]
    assert all("cm" in line for line in after if line.startswith('length = "'))
    file = tmp_path / "design.toml"
    file.write_text(text, encoding="utf-8")
    found = variables(bounds, flexor.load(file)).start
    assert found.tobytes() == vector.tobytes()


def test_a_radius_of_a_parameter_set_stays_a_taper(tmp_path: Path) -> None:
    """With its base and tip in the order and units of the author."""
    problem = Problem.of(flexor.load("finger"), "L+R01", "bending")
    text = designed_model(problem, np.array([0.0987, 0.0061, 0.0083])).to_toml()
    assert 'length = "9.87 cm"' in text
    assert 'radius = { base = "0.61 cm", tip = "0.83 cm" }      # Table I' in text


def test_changes_of_every_kind(tmp_path: Path) -> None:
    """Numbers, tables, entries of lists, and what the file did not have."""
    file = tmp_path / "own.toml"
    file.write_text(TEXT, encoding="utf-8")
    model = flexor.load(file, changes={"rod.length": "0.1234567890123456 m"})
    changes = {"gravity.x": "1 m/s^2", "rod.radius.tip": "0.00321 m", "title": "Mine"}
    text = changed_model(model, changes).to_toml()
    assert 'length = "12.34567890123456 cm"      # measured' in text
    assert '{ tip = "3.21 mm", base = "0.5 cm" } # tip first' in text
    assert '"1.0e3 kg/m^3"' in text and "[bodies.rod] # the only one" in text
    loaded = parse(text)
    assert float(loaded.rod("rod").length) == 0.1234567890123456
    assert loaded.title == "Mine" and float(loaded.gravity.x) == 1.0


def test_a_variant_is_chosen_in_the_text() -> None:
    """It stays a file with variants."""
    text = flexor.load("finger", "printed").to_toml()
    assert 'use = "printed"' in text and "# Table I" in text
    assert parse(text) == flexor.load("finger", "printed").file


def test_choices_leave_out_what_there_is_not() -> None:
    """And the model file is still its author's."""
    given = {"middle": ["with", "without"]}
    without = combinations(given, flexor.load("pneumatic-finger"))[1].model
    text = without.to_toml()
    assert "middle = {" not in text and "# webbing" not in text
    assert "# chosen: webbing, 15 mm wide" in text
    assert parse(text) == without.file


def test_what_cannot_be_changed_in_place_is_written_in_full() -> None:
    """A text that is not the model's is not used."""
    model = flexor.load("column")
    assert model.written is not None
    other = flexor.load("finger")
    other.written = model.written
    assert other.to_toml() == other.file.to_toml()
