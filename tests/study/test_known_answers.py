"""Design problems with constraints whose optimum is known in closed form, through `optimize`."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.model import Model, parse
from flexor.observables import observables
from flexor.study import Problem

BEAM = """
name = "beam"
planar = true

[materials.rubber]
kind = "linear"
young_modulus = "2 MPa"
density = "1100 kg/m^3"

[bodies.beam]
kind = "rod"
length = "20 cm"
radius = "5 mm"
strain = { bend_y = "nodal_linear", extend_x = "nodal_linear" }
elements = 2
gauss_points = 2
section = { kind = "composite", parts = [
    { shape = "rectangle", width = "9 mm", height = "8 mm", material = "rubber" },
] }

[wrenches.turn]
body = "beam"
at = "tip"
moment = { y = "10 N*mm" }
"""

BENDER = """
name = "bender"
planar = true

[materials.rubber]
kind = "linear"
young_modulus = "2 MPa"

[bodies.bender]
kind = "rod"
length = "20 cm"
radius = "5 mm"
strain = { bend_y = "nodal_linear", extend_x = "nodal_linear" }
elements = 2
gauss_points = 2
section = { kind = "composite", parts = [
    { shape = "rectangle", z = "-3 mm", width = "10 mm", height = "4 mm", material = "rubber" },
    { shape = "rectangle", z = "5 mm", width = "10 mm", height = "2 mm", material = "rubber" },
    { shape = "rectangle", z = "2 mm", width = "8 mm", height = "4 mm", cavity = "bore" },
] }

[actuators.air]
kind = "pressure"
rod = "bender"

[evaluation]
pressure = "50 kPa"
pressure_step = "25 kPa"
"""


def test_a_beam_of_least_mass_for_a_stiffness() -> None:
    """Its end turns by M L / (E b h³/12), the more mass the less."""
    model = Model(parse(BEAM))
    study = flexor.optimize(
        model,
        {"beam.section.parts.0.height": ("3 mm", "15 mm")},
        "minimise mass",
        subject_to=["rod-bending <= 0.5 rad"],
        without=["defaults"],
        seed=1,
    )
    height = (12.0 * 0.01 * 0.2 / (2e6 * 0.009 * 0.5)) ** (1.0 / 3.0)
    assert study.best.feasible
    assert study.best.vector[0] == pytest.approx(height, rel=1e-6)
    assert study.best.shown == pytest.approx(1e3 * 1100.0 * 0.2 * 0.009 * height, rel=1e-6)


def test_two_dimensions_of_the_beam_follow_their_cost() -> None:
    """A higher beam is lighter at equal stiffness: its height is at a bound, the width follows."""
    model = Model(parse(BEAM))
    study = flexor.optimize(
        model,
        {
            "beam.section.parts.0.height": ("3 mm", "10 mm"),
            "beam.section.parts.0.width": ("3 mm", "40 mm"),
        },
        "minimise mass",
        subject_to=["rod-bending <= 0.5 rad"],
        without=["defaults"],
    )
    width = 12.0 * 0.01 * 0.2 / (2e6 * 0.01**3 * 0.5)
    np.testing.assert_allclose(study.best.vector, [0.010, width], rtol=1e-6)


def test_a_pressure_for_a_curvature() -> None:
    """Of a linear section with an eccentric cavity: K (ε, κ) = p A (1, z)."""
    model = Model(parse(BENDER))
    study = flexor.optimize(
        model,
        {"evaluation.pressure": ("20 kPa", "100 kPa")},
        "minimise pressure",
        subject_to=["rod-bending >= 30 deg at end"],
        without=["defaults"],
    )
    stiffness = np.zeros((2, 2))
    for z, height in ((-0.003, 0.004), (0.005, 0.002)):
        area = 0.010 * height
        second = 0.010 * height**3 / 12 + area * z * z
        stiffness += 2e6 * np.array([[area, area * z], [area * z, second]])
    cavity = 0.008 * 0.004
    _, curvature = np.linalg.solve(stiffness, cavity * np.array([1.0, 0.002]))
    pressure = np.radians(30.0) / (0.2 * curvature)
    assert study.best.feasible
    assert study.best.vector[0] == pytest.approx(pressure, rel=1e-6)
    written = study.problem.parameters.changes(study.best.vector)
    again = flexor.load(model.file, changes=written).equilibrium()
    assert again.rod_bending[-1, 0] == pytest.approx(np.radians(30.0), rel=1e-6)
    assert study.best.path.loads[-1, 0] == pytest.approx(pressure, rel=1e-6)


def test_gradients_by_loads_are_those_of_differences() -> None:
    """Of the pneumatic finger, by the pressure and a dimension."""
    model = flexor.load("pneumatic-finger")
    fields = {"evaluation.pressure": ("30 kPa", "60 kPa"), "exosuit.length": ("9 cm", "11 cm")}
    problem = Problem.of(
        model,
        fields,
        "maximise range-of-motion",
        subject_to=["pressure <= 60 kPa", "strap-force <= 60 N"],
        options={"tolerance": 1e-12},
    )
    span = problem.parameters.upper - problem.parameters.lower
    x = problem.parameters.lower + 0.4 * span
    here = problem.evaluate(x[None], gradient=True)
    assert here.regularity[0] == "regular"
    exact = np.concatenate([here.value_gradient[0][None], here.constraint_gradients[0]]) * span
    for k in range(2):
        step = 1e-4 * np.eye(2)[k] * span
        found = problem.evaluate(np.stack([x - step, x + step]))
        values = np.column_stack([found.value, found.constraint_values])
        slope = (values[1] - values[0]) / 2e-4
        size = np.abs(exact).max(axis=1)
        exists = ~np.isnan(slope)
        np.testing.assert_allclose(exact[exists, k], slope[exists], atol=2e-6 * size.max())


@pytest.mark.parametrize(
    ("subject_to", "message"),
    [
        (["overlap <= -1 mm"], "can never hold: overlap is never below 0 mm"),
        (["bending <= 10 deg", "bending >= 20 deg"], "can never hold both"),
        (["range-of-motion >= 9 deg"], "under the first load range-of-motion is 0 deg"),
        (["pressure <= 50 kPa"], "the loads go to 60 kPa for every design"),
    ],
)
def test_what_can_never_hold_is_said_before_searching(subject_to: list[str], message: str) -> None:
    model = flexor.load("pneumatic-finger")
    fields = {"exosuit.length": ("9 cm", "11 cm")}
    with pytest.raises(InputError, match=message):
        Problem.of(model, fields, "maximise bending", subject_to=subject_to)


def test_loads_that_are_no_variables() -> None:
    model = flexor.load("pneumatic-finger")
    for bounds, message in (
        ({"evaluation.loads.chamber": ("1 kPa", "2 kPa")}, "unknown input with evaluation.loads"),
        ({"evaluation.pressure": (1, 2)}, "expected a value with its unit"),
    ):
        with pytest.raises(InputError, match=message):
            Problem.of(model, bounds, "maximise bending")


def test_the_distance_to_the_next_snap_is_that_of_the_truss() -> None:
    """It snaps at the maximum of 2 k (l0 - l) z / l, and not again: the springs are then pulled."""
    model = flexor.load("truss")
    z = np.linspace(0.0, 0.02, 20001)
    length, rest = np.sqrt(0.1**2 + z**2), np.hypot(0.1, 0.02)
    limit = float((2e3 * (rest - length) * z / length).max())
    path = model.equilibrium([0.0, 0.1, 0.2])
    margin = observables(model)["snap-margin"].values(path.as_batch)
    assert margin.shape == (1, 3)
    np.testing.assert_allclose(margin, limit / 0.2 - 1.0, rtol=1e-3)
    beyond = model.equilibrium([0.0, 0.2, 0.4])
    assert [event.kind for event in beyond.events] == ["snap"]
    np.testing.assert_array_equal(observables(model)["snap-margin"].values(beyond.as_batch), 1.0)
