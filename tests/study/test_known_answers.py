"""Design problems with constraints whose optimum is known in closed form, through `optimize`."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.model import Model, parse
from flexor.observables import observables
from flexor.study import Problem
from flexor.study.sentences import cautions

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

ROUND = """
name = "beam"
planar = true

[bodies.beam]
kind = "rod"
length = "20 cm"
radius = "8 mm"
young_modulus = "2 MPa"
poisson_ratio = 0.5
density = "1100 kg/m^3"
strain = { bend_y = "nodal_linear" }
elements = 2
gauss_points = 2

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
        (["pressure >= 30 kPa"], "the loads go to 0 kPa for every design"),
        (["pressure >= 61 kPa at end"], "the loads go to 60 kPa for every design"),
    ],
)
def test_what_can_never_hold_is_said_before_searching(subject_to: list[str], message: str) -> None:
    model = flexor.load("pneumatic-finger")
    fields = {"exosuit.length": ("9 cm", "11 cm")}
    with pytest.raises(InputError, match=message):
        Problem.of(model, fields, "maximise bending", subject_to=subject_to)


def test_what_holds_at_the_last_load_is_no_contradiction() -> None:
    model, fields = flexor.load("pneumatic-finger"), {"exosuit.length": ("9 cm", "11 cm")}
    kept = ["pressure >= 60 kPa at end"]
    problem = Problem.of(model, fields, "maximise bending", subject_to=kept)
    found = problem.evaluate(problem.parameters.start[None])
    assert found.constraint_values[0, -1] == 60e3


def test_loads_that_are_no_variables() -> None:
    model = flexor.load("pneumatic-finger")
    for bounds, message in (
        ({"evaluation.loads.chamber": ("1 kPa", "2 kPa")}, "those of evaluation.pressure"),
        ({"evaluation.loads.chmber": ("1 kPa", "2 kPa")}, 'did you mean "chamber"'),
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
    np.testing.assert_array_equal(observables(model)["snaps"].values(beyond.as_batch), 1.0)


def test_buckling_is_no_snap() -> None:
    """A column leaves its straight branch continuously; which way is chance, and that is said."""
    column = flexor.load("column")
    varied = {"column.length": ("15 cm", "17 cm")}
    study = flexor.optimize(column, varied, "minimise energy", subject_to=["snaps <= 0"], budget=1)
    assert [event.kind for event in study.best.path.events] == ["bifurcation"]
    assert study.best.feasible
    assert (study.best.verdict.snaps, study.best.verdict.bifurcations) == (0, 1)
    assert "FRAGILE: the design is reached through a bifurcation." in cautions(study.best)


def test_the_stiffness_of_a_cantilever_at_its_tip() -> None:
    """3 E I / L^3, and of links on springs that of levers in series."""
    beam = flexor.load(parse(BEAM), changes={"turn.moment.y": "1e-6 N*mm"}).equilibrium()
    inertia = 0.009 * 0.008**3 / 12.0
    found = observables(beam.model)["tip-stiffness.beam"].values(beam.as_batch)[0, 0]
    assert found == pytest.approx(3.0 * 2e6 * inertia / 0.2**3, rel=1e-8)
    finger = flexor.load("pneumatic-finger").equilibrium([0.0])
    arms, springs = np.array([0.0939, 0.0489, 0.0236]), np.array([0.04, 0.03, 0.02])
    found = observables(finger.model)["tip-stiffness.ph_3"].values(finger.as_batch)[0, 0]
    assert found == pytest.approx(1.0 / (arms**2 / springs).sum(), rel=1e-8)


def test_the_efficiency_is_the_energy_of_the_springs_by_the_work_of_the_pressure() -> None:
    """With the work from 400 small steps of the pressure, by the trapezoidal rule."""
    model = flexor.load("pneumatic-finger")
    path = model.equilibrium(np.linspace(0.0, 60e3, 401))
    volume, pressure = path.as_batch.volume[0, :, 0], path.loads[:, 0]
    work = (0.5 * (pressure[1:] + pressure[:-1]) * np.diff(volume)).sum()
    stored = 0.5 * (np.array([0.04, 0.03, 0.02]) * path.joint_angles[-1] ** 2).sum()
    few = model.equilibrium().as_batch
    found = observables(model)["efficiency"].values(few)[0]
    assert np.isnan(found[0])
    assert found[-1] == pytest.approx(stored / work, rel=1e-4)


def test_a_radius_that_bears_errors_of_itself_and_of_other_fields() -> None:
    """Of a round beam: M L / (E π r⁴/4) with the longest, softest and thinnest is the bound."""
    model = Model(parse(ROUND))
    study = flexor.optimize(
        model,
        {"beam.radius": ("4 mm", "12 mm")},
        "minimise mass",
        subject_to=["rod-bending <= 20 deg"],
        without=["defaults"],
        tolerance={"beam.radius": "0.1 mm", "beam.length": "1 mm", "beam.young_modulus": "50 kPa"},
    )
    bend = np.radians(20.0)
    radius = (4.0 * 0.01 * 0.201 / (np.pi * 1.95e6 * bend)) ** 0.25 + 1e-4
    assert study.best.verdict.robust
    assert study.best.vector[0] == pytest.approx(radius, rel=1e-6)
