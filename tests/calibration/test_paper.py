"""The paper's angles are found from ranges that span decades, without being told the answer."""

from __future__ import annotations

import numpy as np
import pytest

import flexor as package
from flexor.calibration import calibrate, read
from flexor.calibration.combine import variants
from flexor.calibration.reading import parse

FILES = ("examples/paper-targets.toml", "examples/paper-optimum-targets.toml")


@pytest.mark.parametrize("file", FILES)
def test_the_ranges_are_neutral(file: str) -> None:
    ranges = {constant.name: constant.range for constant in read(file)[0].constant}
    assert ranges["E"] == ("10 kPa", "10 MPa")
    assert ranges["lever"] == (1.0, 10.0)
    assert ranges["k"] == ("1 N/m", "10000 N/m")


def test_the_three_angles_are_met(tmp_path) -> None:
    text = read(FILES[0])[1].split("# --- held out")[0]
    path = tmp_path / "angles.toml"
    path.write_text(text)
    chosen = {"base": "follows R_0", "merged": "first two"}
    found = calibrate(
        package.load("finger", "calibrated"), path, samples=1024, starts=3, chosen=chosen
    )
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
    (variant,) = variants(parse(OPTIMUM, "made"), coarse, "made")
    (run,) = variant.runs
    here, close = variant.x(np.array([[0.4, 0.5], [0.41, 0.5]]))
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
