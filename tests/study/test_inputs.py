"""Designs of models with several inputs, each with loads of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.model import Model, parse
from flexor.study import resume

TEXT = """
name = "two-chambers"
planar = true

[materials.silicone]
library = "dragon-skin-30"
winding = "hoop"

[bodies.rod]
kind = "rod"
length = "6 cm"
radius = "8 mm"
material = "silicone"
section = { kind = "half-round", wall = "2 mm", floor = "2 mm" }
strain = { bend_y = "nodal_linear", extend_x = "nodal_linear" }
elements = 3
gauss_points = 2

[bodies.bar]
kind = "link"
length = "4 cm"
radius = "1 cm"
joint = { kind = "revolute", stiffness = "0.05 N*m/rad" }

[springs.tie]
first = { body = "rod", at = "tip" }
second = { body = "bar", at = "tip" }
stiffness = "300 N/m"

[actuators.air]
kind = "pressure"
rod = "rod"

[actuators.line]
kind = "cable"
rod = "rod"
lever = -0.5

[design]
rod = "rod"
length_bounds = ["4 cm", "8 cm"]
radius_bounds = ["6 mm", "10 mm"]
minimum_radius = "5 mm"
"""
LOADS = {"air": "0:20:10 kPa", "line": "0.5 N"}


@pytest.fixture(scope="module")
def model() -> Model:
    return Model(parse(TEXT))


def test_each_input_has_its_loads(model: Model, tmp_path: Path) -> None:
    table = f'{TEXT}\n[evaluation]\nloads = {{ air = "{LOADS["air"]}", line = "0.5 N" }}\n'
    written = Model(parse(table))
    assert written.equilibrium().loads.tolist() == model.equilibrium(LOADS).loads.tolist()
    options: dict[str, Any] = {"parameters": "R01", "objective": "bending"}
    given = flexor.optimize(model, **options, force=LOADS, budget=12, folder=tmp_path / "a")
    taken = flexor.optimize(written, **options, budget=12)
    assert given.best.value == taken.best.value < given.start.value
    column = [written.inputs.index(name) for name in ("air", "line")]
    assert given.problem.loads[-1, column].tolist() == [20e3, 0.5]
    again = resume(tmp_path / "a", budget=14)
    np.testing.assert_array_equal(again.problem.loads, given.problem.loads)
    grid = flexor.landscape(written, "R01", grid=2)
    assert np.isfinite(grid.value).all()


@pytest.mark.parametrize(
    ("loads", "sentence"),
    [
        (None, 'the model "two-chambers" has 2 inputs: give the load of each, as evaluation'),
        ("0:5:1", 'force must name its input, one of "line", "air"'),
        ({"air": "5 N"}, 'load of air is "5 N", which is not a pressure'),
        ({"air": "0:5:1 N"}, 'load of air is "0:5:1 N", which is not a pressure: write'),
        ({"line": "5 kPa"}, 'load of line is "5 kPa", which is not a force'),
        ({"lin": "5 N"}, 'unknown input "lin" (did you mean "line"?)'),
        (
            {"air": "0:4:1 kPa", "line": "0:2:1"},
            'force has 3 steps for "line" and 5 for another input',
        ),
    ],
)
def test_one_sentence(model: Model, loads: Any, sentence: str) -> None:
    with pytest.raises(InputError) as raised:
        flexor.optimize(model, "R01", "bending", force=loads, budget=2)
    assert sentence in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_study_of_a_model_without_design_is_opened_again(tmp_path: Path) -> None:
    """Fields need no exosuit that `[design]` would name, nor do scenarios and comparisons."""
    model = flexor.load("truss")
    assert model.file.design is None
    name = next(iter(model.file.bodies))
    length = float(model.file.bodies[name].length)
    bounds = {f"{name}.length": (f"{0.9 * length} m", f"{1.1 * length} m")}
    words: dict[str, Any] = {"budget": 4, "without": ["defaults"]}
    study = flexor.optimize(model, bounds, "minimise energy", folder=tmp_path / "s", **words)
    best = study.best.vector
    study.close()
    again = flexor.study.Study.open(tmp_path / "s")
    assert again.best.vector == pytest.approx(best, rel=0.0, abs=0.0)
    again.close()
    assert flexor.study.rerun(tmp_path / "s").same
    resume(tmp_path / "s", budget=6).close()
