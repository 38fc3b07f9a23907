"""The paper's angles are found from ranges that span decades, without being told the answer."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

import flexor as package
from flexor.calibration import calibrate, read
from flexor.calibration.problem import bind_problem
from flexor.calibration.reading import parse

FOLDER = Path(__file__).resolve().parents[2] / "reproduction"
FILES = (FOLDER / "paper-targets.toml", FOLDER / "paper-optimum-targets.toml")


@pytest.mark.parametrize("file", FILES)
def test_the_ranges_are_neutral(file: Path) -> None:
    ranges = {constant.name: constant.range for constant in read(file)[0].constant}
    assert ranges["E"] == ("10 kPa", "10 MPa")
    assert ranges["lever"] == (1.0, 10.0)
    assert ranges["k"] == ("1 N/m", "10000 N/m")


def test_the_three_angles_are_met(tmp_path) -> None:
    text = read(FILES[0])[1].split("# --- held out")[0]
    path = tmp_path / "angles.toml"
    path.write_text(text)
    found = calibrate(package.load("finger", "calibrated"), path, samples=1024, starts=3)
    assert found.best.met
    models = found.best.models()
    three, two = models["finger"], models["finger-2-links"]
    chosen = package.design.parameter_set("L+R01", three.design)
    design = chosen.geometry([[0.108, 0.0065, 0.0074]], three.X)
    bending = [
        path.joint_angles[-1].sum()
        for path in (
            three.equilibrium("0:10:2"),
            two.equilibrium("0:10:2"),
            three.equilibrium("0:5:1", design=design),
        )
    ]
    np.testing.assert_allclose(bending, [1.05, 0.27, 1.43], rtol=0.01)


OPTIMUM = """
[[constant]]
name = "E"
fields = ["exosuit.young_modulus"]
range = ["1 MPa", "4 MPa"]
scale = "log"
[[constant]]
name = "K"
fields = ["ph_1.joint.stiffness"]
range = ["0.02 N*m/rad", "0.06 N*m/rad"]
scale = "log"
[[target]]
name = "best"
observable = "optimum"
parameters = "L"
of = "bending"
force = "0:4:1"
value = "0.5 rad"
tolerance = "0.1 rad"
options = { tolerance = 1e-6 }
"""


def test_beside_a_known_optimum_the_search_is_short_and_as_good(coarse) -> None:
    problem = bind_problem(parse(OPTIMUM, "made"), coarse, "made")
    (run,) = problem.runs
    here, close = problem.x(np.array([[0.4, 0.5], [0.41, 0.5]]))
    best = run.evaluate(here[None, :])[0]
    # Where it is known it stays, or finds what the whole search had left open.
    again = run.beside(here[None, :], best)[0]
    assert again[-1] >= best[-1] - 1e-9
    np.testing.assert_allclose(again, best, rtol=0.01)
    # Close by it follows, and is at least as good as the design it came from.
    followed = run.beside(close[None, :], best)[0]
    whole = run.evaluate(close[None, :])[0]
    np.testing.assert_allclose(followed, whole, rtol=0.01)
    model = run.system.model(close)
    stayed = package.design.parameter_set("L", model.design).geometry([[best[0]]], model.X)
    assert followed[-1] >= model.equilibrium("0:4:1", design=stayed).joint_angles[-1].sum() - 1e-9


@pytest.fixture(scope="module")
def choices():
    spec = importlib.util.spec_from_file_location("choices", FOLDER / "choices.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["choices"] = module
    spec.loader.exec_module(module)
    return module


def test_choices_change_models_and_fix_constants(choices, tmp_path) -> None:
    seen = set()
    for name, choice in choices.CHOICES.items():
        model, targets = choices.prepare(name, choice, tmp_path)
        problem = bind_problem(read(targets)[0], model, str(targets))
        seen.add((choice.targets, *(s.file.to_toml() for s in problem.systems.values())))
        fitted = {constant.name for constant in problem.constants}
        assert fitted == {"E", "lever", "k"} - set(choice.fixed)
    assert len(seen) == len(choices.CHOICES)  # none is without effect
    model, targets = choices.prepare("x", choices.CHOICES["chamber on the surface"], tmp_path)
    problem = bind_problem(read(targets)[0], model, str(targets))
    for system in problem.systems.values():
        assert system.reference.slot("chamber.lever").tolist() == [0.0, 1.0]
    model, targets = choices.prepare("x", choices.CHOICES["base stays at 3.32 cm"], tmp_path)
    placement = model.file.bodies["exosuit"].placement
    assert (placement.reference, float(placement.z)) == ("axis", 0.0332)
