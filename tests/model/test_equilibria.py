"""An equilibrium is what it says: small models with known answers, at any scale."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import flexor
from flexor.model import Model
from flexor.model.results import Path as EquilibriumPath


def made(folder: Path, text: str) -> Model:
    file = folder / "model.toml"
    file.write_text(text, encoding="utf-8")
    return flexor.load(file)


def kinds(path: EquilibriumPath) -> list[str]:
    return [event.kind for event in path.events]


PENDULUM = """
name = "pendulum"
planar = true
gravity = {{ z = "-9.81 m/s^2" }}
[bodies.link]
kind = "link"
length = "{length} m"
radius = "{radius} m"
density = "1 g/cm^3"
joint = {{ kind = "revolute" }}
"""


@pytest.mark.parametrize("length", [1e-6, 1e-3, 1.0, 1e3])
def test_a_pendulum_of_any_size_hangs(tmp_path: Path, length: float) -> None:
    path = made(tmp_path, PENDULUM.format(length=length, radius=0.1 * length)).equilibrium([0.0])
    assert path.stable.all()
    assert np.degrees(path.q[0, 0]) == pytest.approx(90.0, abs=1e-6)


def test_a_weak_spring_is_a_spring(tmp_path: Path) -> None:
    path = made(tmp_path, SLIDER).equilibrium([0.0])
    assert path.stable.all()
    assert path.q[0, 0] == pytest.approx(1e-3, rel=1e-9)


SLIDER = """
name = "slider"
planar = true
[bodies.link]
kind = "link"
length = "1 mm"
radius = "0.1 mm"
joint = { kind = "prismatic", axis = "x" }
[springs.s]
stiffness = "1e-6 N/m"
first = { body = "link", at = "base" }
second = { world = { x = "0 m" } }
[wrenches.f]
body = "link"
at = "tip"
force = { x = "1e-9 N" }
"""

FLAG = """
name = "flag"
planar = true
gravity = { z = "-9.81 m/s^2" }
[bodies.rod]
kind = "rod"
length = "10 cm"
radius = "1 cm"
young_modulus = "200 GPa"
poisson_ratio = 0.3
elements = 2
gauss_points = 3
strain = { bend_y = "nodal_linear" }
[bodies.flag]
kind = "link"
parent = "rod"
length = "2 cm"
radius = "1 mm"
density = "1 g/cm^3"
joint = { kind = "revolute" }
"""


def test_a_stiff_rod_does_not_set_the_unit_of_a_light_flag(tmp_path: Path) -> None:
    path = made(tmp_path, FLAG).equilibrium([0.0])
    assert path.stable.all()
    assert np.degrees(path.joint_angles[0, 0]) == pytest.approx(90.0, abs=1e-5)


TRUSS = """
name = "truss"
planar = true
[bodies.node]
kind = "link"
length = "{s} m"
radius = "{s} m"
joint = {{ kind = "prismatic", axis = "z" }}
placement = {{ z = "{z} m", x = "{x} m" }}
[springs.left]
stiffness = "1000 N/m"
rest_length = "{rest} m"
first = {{ body = "node", at = "tip" }}
second = {{ world = {{ x = "{left} m" }} }}
[springs.right]
stiffness = "1000 N/m"
rest_length = "{rest} m"
first = {{ body = "node", at = "tip" }}
second = {{ world = {{ x = "{right} m" }} }}
[wrenches.push]
body = "node"
at = "tip"
input = true
force = {{ z = "-1 N" }}
"""


@pytest.mark.parametrize("size", [1e-4, 1e-2, 1.0, 1e3])
def test_von_mises_truss_snaps_at_its_limit_point_at_any_size(tmp_path: Path, size: float) -> None:
    a, rise = 0.1, 0.02
    rest = float(np.hypot(a, rise))
    z = np.linspace(0.0, rise, 200_001)
    length = np.hypot(a, z)
    limit = float((2000.0 * (rest - length) * z / length).max()) * size
    numbers = {"s": 1e-3, "z": rise, "x": -1e-3, "rest": rest, "left": -a, "right": a}
    text = TRUSS.format(**{name: repr(size * number) for name, number in numbers.items()})
    path = made(tmp_path, text).equilibrium(limit * np.linspace(0.0, 1.2, 5))
    assert path.stable.all()
    assert kinds(path) == ["snap"]
    assert path.events[0].force == pytest.approx(limit, rel=1e-3)
    assert path.q[-1, 0] / size == pytest.approx(-0.0436843, abs=1e-6)


COLUMN = """
name = "column"
{planar}
[bodies.rod]
kind = "rod"
length = "10 cm"
radius = "5 mm"
young_modulus = "1 MPa"
poisson_ratio = 0.5
elements = 8
gauss_points = 3
strain = {{ bend_y = "nodal_linear"{more} }}
[wrenches.press]
body = "rod"
at = "tip"
force = {{ x = "-1 N" }}
input = true
"""
BREEZE = """
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
EULER = np.pi**2 * 1e6 * np.pi / 4 * 0.005**4 / 4 / 0.1**2


@pytest.mark.parametrize(
    ("planar", "breeze", "steps"),
    [
        *((True, "", steps) for steps in (4, 13, 61)),
        *((False, "", steps) for steps in (4, 13, 61)),
        (False, BREEZE, 4),
        (False, BREEZE, 13),
    ],
)
def test_a_column_bifurcates_once_at_eulers_load(
    tmp_path: Path, planar: bool, breeze: str, steps: int
) -> None:
    text = COLUMN.format(
        planar="planar = true" if planar else "",
        more="" if planar else ', bend_z = "nodal_linear"',
    )
    path = made(tmp_path, text + breeze).equilibrium(np.linspace(0.0, 3.0 * EULER, steps))
    assert path.converged.all()
    assert kinds(path) == ["bifurcation"]
    assert path.events[0].force == pytest.approx(EULER, rel=1e-3)
    assert np.abs(path.q[-1]).max() > 1.0


HINGE = """
name = "free"
planar = true
[bodies.a]
kind = "link"
length = "100 mm"
radius = "5 mm"
joint = { kind = "revolute" }
[bodies.b]
kind = "rod"
parent = "a"
length = "100 mm"
radius = "5 mm"
young_modulus = "1 MPa"
poisson_ratio = 0.5
strain = { bend_y = "nodal_linear" }
elements = 4
gauss_points = 2
[wrenches.m]
body = "a"
at = "tip"
moment = { y = "1 N*m" }
input = true
"""


def test_what_nothing_holds_is_named(tmp_path: Path) -> None:
    path = made(tmp_path, HINGE).equilibrium([0.0, 1.0])
    assert path.status.tolist() == ["converged", "unrestrained"]
    assert path.stability.tolist() == ["neutral", "unknown"]
    assert path.free[0] == ("a.theta",)
    assert path.total_iterations < 1000


def test_a_branch_by_arc_length_names_what_nothing_holds(tmp_path: Path) -> None:
    path = made(tmp_path, HINGE).equilibrium([0.0, 1.0], follow="arc-length")
    assert path.stability[0] == "neutral"
    assert path.free[0] == ("a.theta",)
    assert path.free.shape == path.status.shape


def test_the_limit_of_a_free_hinge_is_no_event(tmp_path: Path) -> None:
    text = HINGE.replace('"revolute" }', '"revolute", lower = "0 deg", upper = "90 deg" }')
    model = made(tmp_path, text)
    path = model.equilibrium([0.0, 0.5, 1.0, 1000.0])
    assert path.converged.all()
    assert not path.events
    beyond = np.degrees(path.joint_angles[3, 0]) - 90.0
    assert path.warnings == [
        f'the joint of "a" is {beyond:.4g} deg beyond its limit, from 1000 N*m on more than '
        "the 10 deg up to which its law is meant"
    ]
    assert np.degrees(path.joint_angles[:, 0]) == pytest.approx([0.0, 93.2, 96.0, 134.0], abs=12.0)


@pytest.mark.parametrize("forces", ["0:1000:250", "0,1000", "0:1:0.25"])
def test_a_limit_met_within_a_sub_step_is_no_event(forces: str, tmp_path: Path) -> None:
    # It begins at one of its limits: the corner there looks like a tangent that softens.
    held = '"revolute", stiffness = "0.01 N*m/rad", lower = "0 deg", upper = "90 deg" }'
    path = made(tmp_path, HINGE.replace('"revolute" }', held)).equilibrium(forces)
    assert path.converged.all()
    assert not path.events


APEX = """
name = "apex"
[bodies.arm]
kind = "link"
length = "10 cm"
radius = "1 cm"
joint = { kind = "spherical", stiffness = "0.001 N*m/rad" }
[springs.s]
stiffness = "1000 N/m"
rest_length = "2 cm"
first = { body = "arm", at = "tip" }
second = { world = { x = "10 cm" } }
"""


def test_a_compressed_spring_with_coincident_ends_is_left(tmp_path: Path) -> None:
    path = made(tmp_path, APEX).equilibrium([0.0])
    assert path.converged.all()
    assert path.energy[0] < 1e-3
    assert np.linalg.norm(path.q[0]) == pytest.approx(0.2, abs=0.01)


EULER_3D = """
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
[wrenches.m]
body = "rod"
at = "tip"
moment = { x = "1e-12 N*m" }
frame = "body"
"""


def test_rest_is_stable_without_a_potential_too(tmp_path: Path) -> None:
    assert made(tmp_path, EULER_3D).equilibrium([0.0]).stability.tolist() == ["stable"]


def test_a_coordinate_that_springs_hold_goes_as_far_as_they_let_it(tmp_path: Path) -> None:
    """Two springs between sliders of short links: they hold the apex, however far it moves."""
    lines = """
        name = "apex"
        planar = true
        [bodies.across]
        kind = "link"
        length = "1 mm"
        radius = "1 mm"
        joint = { kind = "prismatic", axis = "x", stiffness = "0 N/m" }
        [bodies.apex]
        kind = "link"
        parent = "across"
        length = "1 mm"
        radius = "1 mm"
        placement = { x = "-2 mm", z = "3 m" }
        joint = { kind = "prismatic", axis = "z", stiffness = "0 N/m" }
        [wrenches.weight]
        body = "apex"
        at = "tip"
        force = { z = "-1 N" }
        input = true
    """
    for side in (-1, 1):
        lines += f"""
        [springs.side{side}]
        first = {{ body = "apex", at = "tip" }}
        second = {{ world = {{ x = "{side} m" }} }}
        stiffness = "100 N/m"
        rest_length = "{10.0**0.5!r} m"
        """
    path = made(tmp_path, lines).equilibrium([0.0, 70.0, 79.0, 100.0])
    assert path.stable.all()
    assert path.q[:, 0] == pytest.approx(0.0, abs=1e-6)
    height = 3.0 + path.q[-1, 1]
    length = np.hypot(1.0, height)
    pull = 2 * 100.0 * (length - np.sqrt(10.0)) * height / length
    assert height < -3.0
    assert -pull == pytest.approx(100.0, rel=1e-6)
