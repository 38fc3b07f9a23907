"""Limits, rests, gravity, point loads, offsets and paths as design variables, with derivatives."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.design import variables
from flexor.errors import InputError
from flexor.model import Model, parse
from flexor.study import Problem

# A link that is pushed beyond its limit, with a rod on it: under its weight, pulled by a cable and
# by a spring, and loaded at its tip.
ARM = """
name = "arm"
planar = {planar}
gravity = {{ x = "2 m/s^2", z = "-9 m/s^2" }}

[bodies.hinge]
kind = "link"
length = "3 cm"
radius = "1 cm"
density = "2 g/cm^3"

[bodies.hinge.joint]
kind = "revolute"
stiffness = "0.05 N*m/rad"
rest = "5 deg"
lower = "-60 deg"
upper = "-15 deg"
limit_stiffness = "0.5 N*m/rad"
limit_width = "3 deg"

[bodies.slide]
kind = "link"
parent = "hinge"
length = "2 cm"
radius = "1 cm"
density = "1 g/cm^3"

[bodies.slide.joint]
kind = "prismatic"
axis = "x"
stiffness = "2 N/cm"
rest = "1 mm"
lower = "3 mm"
upper = "8 mm"
limit_stiffness = "2 N/mm"
limit_width = "0.3 mm"

[bodies.rod]
kind = "rod"
parent = "slide"
length = "12 cm"
radius = "4 mm"
section = {{ kind = "circular" }}
young_modulus = "2 MPa"
poisson_ratio = 0.45
density = "1 g/cm^3"
strain = {{ {strain} }}
elements = 4
gauss_points = 3

[actuators.cable]
kind = "cable"
rod = "rod"
path = {{ y = "{y}", z = "3 mm" }}

[springs.band]
first = {{ body = "rod", at = "tip", offset = {{ x = "2 mm", y = "{y}", z = "3 mm" }} }}
second = {{ world = {{ x = "20 cm", y = "{y}", z = "10 cm" }} }}
stiffness = "2 N/m"
rest_length = "2 cm"

[wrenches.held]
body = "rod"
at = "tip"
offset = {{ z = "4 mm" }}
force = {{ x = "-0.02 N", z = "0.05 N" }}
moment = {{ y = "1 N*mm" }}

[wrenches.jet]
body = "rod"
at = 0.5
force = {{ x = "0.1 N", z = "0.04 N" }}
moment = {{ y = "2 N*mm" }}
frame = "body"

[evaluation]
loads.cable = "0 N, 0.5 N, 1 N"
"""
PLANAR = ARM.format(
    planar="true", y="0 mm", strain='bend_y = "nodal_linear", extend_x = "nodal_linear"'
)
SPATIAL = ARM.format(
    planar="false",
    y="1 mm",
    strain='bend_y = "nodal_linear", bend_z = "nodal_linear", twist_x = "nodal_linear"',
)
FIELDS: dict[str, tuple[object, object]] = {
    "hinge.joint.rest": ("-10 deg", "10 deg"),
    "hinge.joint.upper": ("-20 deg", "-12 deg"),
    "hinge.joint.limit_stiffness": ("0.2 N*m/rad", "1 N*m/rad"),
    "hinge.joint.limit_width": ("1 deg", "4 deg"),
    "slide.joint.rest": ("0 mm", "2 mm"),
    "slide.joint.lower": ("2.9 mm", "3.5 mm"),
    "slide.joint.limit_stiffness": ("1 N/mm", "3 N/mm"),
    "slide.joint.limit_width": ("0.2 mm", "0.5 mm"),
    "gravity.x": ("-3 m/s^2", "3 m/s^2"),
    "gravity.z": ("-10 m/s^2", "-5 m/s^2"),
    "held.force.x": ("-0.05 N", "0.05 N"),
    "held.force.z": ("0.02 N", "0.08 N"),
    "held.moment.y": ("-2 N*mm", "2 N*mm"),
    "held.offset.z": ("0 mm", "6 mm"),
    "jet.force.x": ("0.05 N", "0.2 N"),
    "jet.moment.y": ("-2 N*mm", "2 N*mm"),
    "band.first.offset.x": ("0 mm", "4 mm"),
    "band.first.offset.z": ("0 mm", "6 mm"),
    "band.second.world.x": ("18 cm", "22 cm"),
    "cable.path.z.0": ("2 mm", "4 mm"),
}
ACROSS: dict[str, tuple[object, object]] = {
    "gravity.y": ("-3 m/s^2", "3 m/s^2"),
    "held.force.y": ("-0.05 N", "0.05 N"),
    "held.moment.x": ("-2 N*mm", "2 N*mm"),
    "jet.force.y": ("-0.05 N", "0.05 N"),
    "jet.moment.z": ("-2 N*mm", "2 N*mm"),
    "band.first.offset.y": ("-2 mm", "2 mm"),
    "band.second.world.y": ("-2 cm", "2 cm"),
    "cable.path.y.0": ("-1 mm", "2 mm"),
}
STENCIL = {1: 45 / 60, 2: -9 / 60, 3: 1 / 60, -1: -45 / 60, -2: 9 / 60, -3: -1 / 60}
STEP = 1e-4


@pytest.mark.parametrize(
    ("text", "fields"), [(PLANAR, FIELDS), (SPATIAL, FIELDS | ACROSS)], ids=["planar", "spatial"]
)
def test_values_and_derivatives(text: str, fields: dict[str, tuple[object, object]]) -> None:
    """Values are those of the changed file, derivatives of observables those of differences."""
    model = Model(parse(text))
    problem = Problem.of(
        model,
        fields,
        "maximise angle.hinge",
        subject_to=["rod-bending.rod <= 1 deg", "bending <= 1 deg"],
        without=["defaults"],
        options={"tolerance": 1e-12},
    )
    chosen = problem.parameters
    span = chosen.upper - chosen.lower
    u = np.random.default_rng(2).uniform(0.05, 0.95, (3, chosen.size))
    x = chosen.lower + u * span
    for row in x:
        found, _ = chosen.designs(row[None, :], model)
        actual = model.parameters.copy()
        actual[found.indices] = found.values[0]
        expected = flexor.load(model.file, changes=chosen.changes(row)).parameters
        np.testing.assert_allclose(actual, expected, rtol=1e-9, atol=1e-14)
    here = problem.evaluate(x, gradient=True)
    assert (here.regularity == "regular").all()
    exact = np.concatenate([here.value_gradient[:, None], here.constraint_gradients], axis=1)
    exact *= span
    differences = np.zeros_like(exact)
    for k in range(chosen.size):
        for at, weight in STENCIL.items():
            moved = problem.evaluate(x + at * STEP * span * np.eye(chosen.size)[k])
            values = np.column_stack([moved.value, moved.constraint_values])
            differences[:, :, k] += weight * values / STEP
    size = np.abs(exact).max(axis=2, keepdims=True)
    assert (np.abs(exact).max(axis=(0, 1)) > 1e-5 * size.max()).all()  # each matters
    assert (np.abs(exact - differences) / size).max() <= 1e-6


@pytest.mark.parametrize(
    ("field", "bounds"),
    [
        ("gravity.z", ("-9 m/s^2", "0 m/s^2")),
        ("held.moment.y", ("0 N*mm", "1 N*mm")),
        ("arm.friction", (0.0, 0.4)),
        ("pull.friction", (0.0, 0.2)),
    ],
)
def test_a_bound_may_be_zero(field: str, bounds: tuple[object, object]) -> None:
    """A model with gravity, a moment or friction may have designs without."""
    model = Model(parse(SPATIAL.replace('x = "2 m/s^2", ', "") + RUBBING))
    chosen = variables({field: bounds}, model)
    x = np.array([chosen.lower, chosen.upper, chosen.start])
    found, valid = chosen.designs(x, model)
    assert valid.all()
    assert 0.0 in found.values
    paths = model.evaluate(found)
    assert paths.converged.all()


RUBBING = """
[bodies.arm]
kind = "rod"
length = "5 cm"
radius = "3 mm"
section = { kind = "circular" }
young_modulus = "2 MPa"
poisson_ratio = 0.45
density = "1 g/cm^3"
strain = { bend_y = "nodal_linear" }
elements = 4
gauss_points = 2
skin = { modulus = "1 MPa", thickness = "1 mm" }
placement = { z = "-1.8 cm" }
friction = 0.3

[bodies.bone]
kind = "link"
length = "5 cm"
radius = "1 cm"
skin = { modulus = "1 MPa", thickness = "1 mm" }
joint = { kind = "fixed" }
placement = { z = "-3.1 cm" }

[tendons.pull]
kind = "spring"
stiffness = "10 N/m"
slack_length = "3 cm"
friction = 0.1
path = [
  { world = { z = "1 cm" } },
  { body = "hinge", at = "tip", offset = { z = "1 cm" } },
  { body = "slide", at = "tip", offset = { z = "1 cm" } },
]
"""


@pytest.mark.parametrize(
    ("field", "bounds", "message"),
    [
        ("gravity.y", ("-1 m/s^2", "1 m/s^2"), "no gravity along y"),
        ("hinge.joint.lower", ("-25 deg", "-10 deg"), "lower limit is not below the upper one"),
        ("held.force.y", ("-1 N", "1 N"), "leaves the x–z plane"),
        ("hinge.joint.limit_width", ("0 deg", "1 deg"), "must be greater than zero"),
    ],
)
def test_what_cannot_be_is_said(field: str, bounds: tuple[object, object], message: str) -> None:
    """In one sentence, with the field."""
    model = Model(parse(PLANAR))
    with pytest.raises(InputError, match=message):
        variables({field: bounds}, model).designs(np.zeros((1, 1)), model)


def test_what_is_zero_in_the_file_is_said() -> None:
    """A model without gravity, friction or a moment is made without them."""
    text = SPATIAL.replace('gravity = { x = "2 m/s^2", z = "-9 m/s^2" }', "")
    text = text.replace('moment = { y = "1 N*mm" }', "")
    model = Model(parse(text))
    for field, bounds in (
        ("gravity.z", ("-9 m/s^2", "1 m/s^2")),
        ("held.moment.y", ("-1 N*mm", "1 N*mm")),
    ):
        chosen = variables({field: bounds}, model)
        with pytest.raises(InputError, match=f'"{field}" cannot be varied: it is zero in the file'):
            chosen.designs(chosen.start[None, :], model)


def test_the_length_of_a_load_stays_what_it_is() -> None:
    """A force of length one whose load is in newtons is no factor of its own."""
    text = PLANAR + (
        '[wrenches.pull]\nbody = "rod"\nat = "tip"\nforce = { z = "1 N" }\ninput = true\n'
    )
    text = text.replace("[evaluation]\n", "[evaluation]\nloads.pull = '0 N, 0 N, 1 N'\n")
    with pytest.raises(InputError, match=r'vary its loads, "evaluation\.loads\.pull"'):
        variables({"pull.force.z": ("0.5 N", "2 N")}, Model(parse(text)))
