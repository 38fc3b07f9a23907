"""Snaps and bifurcations: their kind, their load and their number, whatever the load steps."""

from __future__ import annotations

from importlib import resources

import numpy as np
import pytest

from flexor.model import Model, Path, parse

COLUMN = """
name = "column"
[bodies.rod]
kind = "rod"
length = "10 cm"
radius = "5 mm"
young_modulus = "1 MPa"
poisson_ratio = 0.5
elements = 8
gauss_points = 3
strain = { bend_y = "nodal_linear", bend_z = "nodal_linear", twist_x = "nodal_linear" }
[wrenches.press]
body = "rod"
at = "tip"
force = { x = "-1 N" }
input = true
"""
"""A round column: once buckled, it may turn about its axis."""

FLAG = """
[bodies.flag]
kind = "link"
length = "1 cm"
radius = "2 mm"
joint = { kind = "revolute", stiffness = "1 N*m/rad" }
[wrenches.breeze]
body = "flag"
at = "tip"
frame = "body"
force = { z = "1e-6 N" }
"""
"""A follower load without a potential, too small to matter."""

EULER = np.pi**2 * 1e6 * np.pi / 4 * 0.005**4 / 4 / 0.1**2

STRIP = """
name = "strip"
[bodies.rod]
kind = "rod"
length = "500 mm"
radius = "2 mm"
section = { kind = "rectangular", ratio = 2.0 }
young_modulus = "1 MPa"
poisson_ratio = 0.5
strain = { twist_x = "nodal_quadratic", bend_y = "nodal_quadratic", bend_z = "nodal_quadratic" }
elements = 8
gauss_points = 3
[wrenches.p]
body = "rod"
at = "tip"
force = { x = "-1 N" }
input = true
[wrenches.m]
body = "rod"
at = "tip"
moment = { x = "1e-12 N*m" }
frame = "body"
"""


def kinds(path: Path) -> list[str]:
    """Return the kinds of all events."""
    return [event.kind for event in path.events]


@pytest.mark.parametrize("flag", ["", FLAG])
@pytest.mark.parametrize("steps", [2, 61, 241, 601])
def test_a_buckled_column_that_turns_about_its_axis_has_no_event(flag: str, steps: int) -> None:
    loads = np.linspace(0.0, 3.0 * EULER, steps)
    path = Model(parse(COLUMN + flag)).equilibrium(loads)
    assert path.converged.all()
    assert kinds(path) == ["bifurcation"]
    assert path.events[0].force == pytest.approx(EULER, rel=1e-3)
    buckled = loads > EULER
    assert (path.stability == np.where(buckled, "neutral", "stable")).all()


LINK = """
name = "link"
[bodies.link]
kind = "link"
length = "20 cm"
radius = "3 mm"
joint = { kind = "spherical", stiffness = "0.0133 N*m/rad" }
[wrenches.press]
body = "link"
at = "tip"
force = { x = "-1 N" }
input = true
"""
"""Buckles at 0.0133 N·m/rad / 20 cm."""


@pytest.mark.parametrize(("times", "steps"), [(3, 3), (10, 10), (10, 50), (100, 50), (100, 300)])
def test_a_bifurcation_at_a_load_of_the_path_is_seen_there(times: int, steps: int) -> None:
    critical = 0.0133 / 0.2
    loads = np.linspace(0.0, times * critical, steps + 1)[1:]
    path = Model(parse(LINK)).equilibrium(loads)
    assert kinds(path) == ["bifurcation"]
    assert path.events[0].force == pytest.approx(critical, rel=1e-9)
    assert (path.stability[loads > 1.001 * critical] == "neutral").all()


def test_what_follows_changes_no_state_under_large_forces() -> None:
    side = '[wrenches.side]\nbody = "link"\nat = "tip"\nforce = { z = "1 N" }\ninput = true\n'
    model = Model(parse(LINK + side))
    push = 0.10514573220059859
    loads = np.array([[1.6625, push], [3.325, push], [4.9875, -push], [5.985, -push]])
    path, first = model.equilibrium(loads), model.equilibrium(loads[:3])
    # The link leans against the side force until it snaps to the other side.
    assert kinds(path) == kinds(first) == ["snap"]
    assert path.q[2, 1] > 0.0
    np.testing.assert_allclose(path.q[:3], first.q, atol=1e-7)


@pytest.mark.parametrize("steps", [3, 20, 100])
def test_a_column_that_buckles_under_its_weight_turns_about_its_axis(steps: int) -> None:
    def model(young_modulus: float) -> Model:
        gravity = 'name = "column"\ngravity = { x = "-9.81 m/s^2" }\n'
        column = COLUMN.replace('name = "column"\n', gravity)
        rod = f'density = "1100 kg/m^3"\nyoung_modulus = "{young_modulus} Pa"'
        return Model(parse(column.replace('young_modulus = "1 MPa"', rod)))

    # Greenhill: the weight per length is 7.8373 EI / L^3.
    weight, length = 1100.0 * 9.81 * np.pi * 0.005**2, 0.1
    critical = weight * length**3 / (7.8373 * np.pi / 4 * 0.005**4)
    loads = np.linspace(0.0, 1e-4, steps)
    assert (model(1.02 * critical).equilibrium(loads[:1]).stability == "stable").all()
    path = model(0.9 * critical).equilibrium(loads)
    assert kinds(path) == []
    assert (path.stability == "neutral").all()


@pytest.mark.parametrize("steps", [2, 101])
def test_a_bifurcation_within_the_smallest_sub_step_is_seen_at_its_load(steps: int) -> None:
    path = Model(parse(STRIP)).equilibrium(np.linspace(0.0, 1.0, steps))
    euler = np.pi**2 * 1e6 * (8e-3 * 4e-3**3 / 12) / 4 / 0.5**2
    assert path.converged.all()
    assert kinds(path) == ["bifurcation"]
    assert path.events[0].force == pytest.approx(euler, rel=2e-2)


ANGLE = """
name = "angle"
[bodies.one]
kind = "rod"
length = "24 cm"
radius = "5 mm"
section = { kind = "rectangular", ratio = 5.0 }
young_modulus = "10 MPa"
poisson_ratio = 0.3
strain = { twist_x = "nodal_linear", bend_y = "nodal_linear", bend_z = "nodal_linear" }
elements = 8
gauss_points = 3
[bodies.two]
kind = "rod"
parent = "one"
length = "24 cm"
radius = "5 mm"
section = { kind = "rectangular", ratio = 5.0 }
young_modulus = "10 MPa"
poisson_ratio = 0.3
placement = { rotation = { z = "90 deg" } }
strain = { twist_x = "nodal_linear", bend_y = "nodal_linear", bend_z = "nodal_linear" }
elements = 8
gauss_points = 3
[wrenches.p]
body = "two"
at = "tip"
force = { x = "-1 N" }
input = true
"""


def test_a_right_angle_frame_buckles_out_of_its_plane_at_one_load() -> None:
    model = Model(parse(ANGLE))
    loads = []
    for steps in (2, 11, 51):
        path = model.equilibrium(np.linspace(0.0, 2.0, steps))
        assert path.converged.all()
        assert kinds(path) == ["bifurcation"]
        loads.append(path.events[0].force)
    assert np.ptp(loads) < 1e-9 * loads[0]


ARCH = """
name = "arch"
planar = true
[bodies.arch]
kind = "rod"
length = "{length} m"
radius = "1 cm"
young_modulus = "1 GPa"
poisson_ratio = 0.3
placement = {{ rotation = {{ y = "-107.5 deg" }} }}
strain = {{ bend_y = "nodal_quadratic" }}
reference_strain = {{ bend_y = "1 rad/m" }}
elements = 16
gauss_points = 3
[springs.hinge]
first = {{ body = "arch", at = "tip" }}
second = {{ world = {{ x = "{span} m" }} }}
stiffness = "1e6 N/m"
[wrenches.crown]
body = "arch"
at = 0.5
force = {{ z = "-1 N" }}
input = true
"""


@pytest.mark.parametrize("steps", [2, 21])
def test_a_deep_arch_snaps_once(steps: int) -> None:
    # Clamped at one end, hinged at the other, half angle 107.5°: 8.97 EI/R² (DaDeppo and Schmidt).
    half = np.radians(107.5)
    model = Model(parse(ARCH.format(length=float(2 * half), span=float(2 * np.sin(half)))))
    stiffness = 1e9 * np.pi / 4 * 1e-8
    path = model.equilibrium(np.linspace(0.0, 9.6 * stiffness, steps))
    assert path.converged.all()
    assert kinds(path) == ["snap"]
    assert path.events[0].force / stiffness == pytest.approx(8.97, abs=0.02)
    branch = model.equilibrium([0.0, 9.6 * stiffness], follow="arc-length")
    limit = branch.force[np.flatnonzero(np.diff(branch.force) < 0.0)[0]]
    assert path.events[0].force == pytest.approx(limit, rel=2e-3)


@pytest.mark.parametrize("length", [1e-6, 1.0, 1e3])
@pytest.mark.parametrize("force", [1e-9, 1.0, 1e9])
def test_a_path_scales_with_length_and_force(length: float, force: float) -> None:
    # Lengths times L and forces times F: moduli times F/L²; angles and events stay.
    text = ANGLE
    for number, unit in (("24 cm", 0.24 * length), ("5 mm", 0.005 * length)):
        text = text.replace(f'"{number}"', f'"{unit!r} m"')
    text = text.replace('"10 MPa"', f'"{1e7 * force / length**2!r} Pa"')
    scaled = Model(parse(text)).equilibrium(force * np.linspace(0.0, 2.0, 5))
    plain = Model(parse(ANGLE)).equilibrium(np.linspace(0.0, 2.0, 5))
    assert scaled.converged.all()
    assert kinds(scaled) == kinds(plain)
    assert scaled.events[0].force / force == pytest.approx(plain.events[0].force, rel=1e-6)
    assert scaled.q == pytest.approx(plain.q, abs=1e-6)


BRICK = """
[bodies.brick]
kind = "rod"
length = "10 cm"
radius = "5 cm"
young_modulus = "200 GPa"
poisson_ratio = 0.3
elements = 1
gauss_points = 2
placement = { x = "-1 m" }
strain = { extend_x = "nodal_linear" }
[actuators.other]
kind = "chamber"
rod = "brick"
"""


def test_what_another_input_is_held_at_changes_no_bit() -> None:
    text = resources.files("flexor.examples").joinpath("finger.toml").read_text("utf-8")
    engine = Model(parse(text + BRICK, use="calibrated")).engine
    slot = engine.slots["exosuit.young_modulus"][0]
    values = np.geomspace(2e5, 3e6, 30)[:, None]
    paths = []
    for held in (0.0, 100.0, 1e4):
        loads = np.array([[load, held] for load in (0.0, 2.5, 5.0)])
        paths.append(engine.path([slot], values, loads, 1))
    own = [i for i, name in enumerate(engine.coordinates) if not name.startswith("brick")]
    assert len(paths[0]["events"]["design"]) > 5
    for other in paths[1:]:
        assert np.array_equal(paths[0]["q"][..., own], other["q"][..., own])
        for key in ("design", "step", "kind"):
            assert np.array_equal(paths[0]["events"][key], other["events"][key])


TRUSS = """
name = "truss"
planar = true
[bodies.mast]
kind = "link"
length = "300 m"
radius = "1 m"
{mast}
{node}
[springs.l]
stiffness = "1000 N/m"
rest_length = "0.10198039027185571 m"
first = {{ body = "{body}", at = "tip" }}
second = {{ world = {{ x = "-10 cm" }} }}
[springs.r]
stiffness = "1000 N/m"
rest_length = "0.10198039027185571 m"
first = {{ body = "{body}", at = "tip" }}
second = {{ world = {{ x = "10 cm" }} }}
[wrenches.push]
body = "{body}"
at = "tip"
force = {{ z = "-1 N" }}
input = true
"""
SLIDE = """
[bodies.node]
kind = "link"
parent = "mast"
length = "1 mm"
radius = "1 mm"
placement = { x = "-1 mm", z = "2 cm" }
joint = { kind = "prismatic", axis = "z" }
"""


@pytest.mark.parametrize("steps", [2, 20])
@pytest.mark.parametrize("part", ["slide", "hinge"])
def test_a_small_truss_on_a_long_body_snaps(part: str, steps: int) -> None:
    slides = part == "slide"
    mast = 'placement = { x = "-300 m" }'
    if not slides:
        mast = 'placement = { x = "-300 m", z = "2 cm" }\njoint = { kind = "revolute", axis = "y" }'
    text = TRUSS.format(mast=mast, node=SLIDE if slides else "", body="node" if slides else "mast")
    path = Model(parse(text)).equilibrium(np.linspace(0.0, 40.0, steps))
    z = np.linspace(0.0, 0.02, 200_001)
    limit = (2000.0 * (np.hypot(0.1, 0.02) / np.hypot(0.1, z) - 1.0) * z).max()
    assert path.converged.all()
    assert kinds(path) == ["snap"]
    assert path.events[0].force == pytest.approx(limit, rel=1e-6)
