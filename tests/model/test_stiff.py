"""Stiff springs and contacts, free motions and follower loads: solved, or why not."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor import _engine
from flexor.cli.simulate import report
from flexor.model import Model, parse

CONVERGED = _engine.STATUS.index("converged")


@pytest.mark.parametrize("constants", ["surface", "calibrated"])
@pytest.mark.parametrize("stiffness", [1e6, 1e8, 1e11, 1e12])
def test_stiff_contact_is_solved_as_far_as_rounding_allows(
    constants: str, stiffness: float
) -> None:
    model = flexor.load("finger", constants)
    slot = model.engine.slots["skin.stiffness"][0]
    loads = np.arange(6.0)[:, None]
    found = model.engine.path([slot], [[stiffness]], loads, 1)
    assert (found["status"] == CONVERGED).all()
    assert (found["residual"] <= found["tolerance"]).all()
    assert (found["tolerance"] < 1e-2).all()
    assert (found["touching"][0, 2:] > 0).all()
    # Thousands while every step was limited by the curvature of the contact.
    assert found["iterations"].sum() < 300
    softer = model.engine.path([slot], [[stiffness / 10.0]], loads, 1)
    np.testing.assert_allclose(found["q"], softer["q"], atol=3e-2)


BARE = """
name = "x"
planar = true
[bodies.suit]
kind = "rod"
length = "10 cm"
radius = "1 cm"
young_modulus = "300 kPa"
poisson_ratio = 0.5
elements = 8
gauss_points = 3
placement = { z = "1 cm", reference = "underside" }
strain = { bend_y = "nodal_linear", extend_x = "nodal_linear" }
[bodies.bar]
kind = "link"
length = "9 cm"
radius = "1 cm"
joint = { kind = "revolute", stiffness = "0.05 N*m/rad" }
[spheres.suit]
bodies = ["suit"]
[spheres.bar]
points = [
    { body = "bar", at = "base" },
    { body = "bar", at = 0.25 },
    { body = "bar", at = 0.5 },
    { body = "bar", at = 0.75 },
    { body = "bar", at = "tip" },
]
[contacts.skin]
first = "suit"
second = "bar"
stiffness = "1 N/m"
[actuators.chamber]
kind = "chamber"
rod = "suit"
lever = 1.0
"""


@pytest.mark.parametrize(
    ("stiffness", "reason"),
    [("1e13", "rounding is 0.019 of the forces"), ("1e15", "of the forces, above its bound of")],
)
def test_a_stiffness_beyond_rounding_stalls_and_is_named(
    stiffness: str, reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    model = Model(parse(BARE.replace('"1 N/m"', '"1e12 N/m"')))
    assert model.equilibrium(range(6)).converged.all()
    model = Model(parse(BARE.replace('"1 N/m"', f'"{stiffness} N/m"')))
    path = model.equilibrium(range(6))
    done = path.converged
    assert (path.residual[done] <= path.tolerance[done]).all()
    assert "stalled" in path.status
    assert path.iterations.sum() < 600
    report(path)
    said = capsys.readouterr().out.replace("\n", " ")
    assert reason in said
    assert f"contacts.skin, {float(stiffness):.3g} N/m" in said


def test_stiff_springs_solve_like_softer_ones() -> None:
    beam = """
name = "beam"
planar = true
[bodies.rod]
kind = "rod"
length = "1 m"
radius = "1 cm"
young_modulus = "10 MPa"
poisson_ratio = 0.3
joint = {{ kind = "revolute" }}
strain = {{ bend_y = "nodal_quadratic" }}
elements = 8
gauss_points = 3
[springs.rope]
first = {{ body = "rod", at = "tip" }}
second = {{ world = {{ x = "40 cm", z = "50 cm" }} }}
stiffness = "{stiffness} N/m"
rest_length = "50 cm"
slack = true
[wrenches.p]
body = "rod"
at = 0.5
force = {{ z = "-1 N" }}
input = true
"""
    forces = np.linspace(0.0, 3.0, 7)
    soft, stiff = (
        Model(parse(beam.format(stiffness=k))).equilibrium(forces, tolerance=1e-8)
        for k in (1e4, 1e9)
    )
    assert soft.converged.all() and stiff.converged.all()
    np.testing.assert_allclose(stiff.q[1:], soft.q[1:], atol=5e-3)
    assert stiff.iterations.sum() < 150


CONCENTRIC = """
name = "beads"
planar = true
[bodies.fixed]
kind = "link"
length = "1 cm"
radius = "1 cm"
[bodies.bead]
kind = "link"
length = "1 cm"
radius = "1 cm"
joint = { kind = "prismatic", axis = "x", stiffness = "10 N/m" }
[spheres.fixed]
points = [{ body = "fixed", at = "base" }]
[spheres.bead]
points = [{ body = "bead", at = "base" }]
[contacts.touch]
first = "bead"
second = "fixed"
stiffness = "100 N/m"
"""


def test_concentric_spheres_part_and_always_to_the_same_side() -> None:
    places = [Model(parse(CONCENTRIC)).equilibrium([0.0]).q[0, 0] for _ in range(2)]
    assert places[0] == places[1]
    # 100 (2R - |x|) = 10 |x|.
    assert abs(places[0]) == pytest.approx(100.0 * 0.02 / 110.0, rel=1e-8)


SLIDERS = """
name = "sliders"
planar = true
[bodies.one]
kind = "link"
length = "1 cm"
radius = "1 mm"
joint = { kind = "prismatic", axis = "x" }
[bodies.two]
kind = "link"
parent = "one"
length = "1 cm"
radius = "1 mm"
joint = { kind = "prismatic", axis = "x" }
[wrenches.p]
body = "two"
at = "tip"
force = { x = "1 N" }
input = true
"""
SUPPORTS = """
[springs.a]
first = { body = "two", at = "tip" }
second = { world = { x = "4 cm" } }
stiffness = "100 N/m"
[springs.b]
first = { body = "two", at = "tip" }
second = { world = { x = "4 cm" } }
stiffness = "100 N/m"
"""


def test_a_redundant_mechanism_is_named() -> None:
    path = Model(parse(SLIDERS)).equilibrium([0.0])
    assert path.status.tolist() == ["converged"] and path.stability.tolist() == ["neutral"]
    assert {name.split(".")[0] for name in path.free[0]} == {"one", "two"}
    assert path.iterations.sum() < 20
    pulled = Model(parse(SLIDERS)).equilibrium([0.0, 1.0])
    assert pulled.status[-1] == "unrestrained"
    assert pulled.iterations.sum() < 100


def test_dependent_supports_hold_what_they_hold() -> None:
    path = Model(parse(SLIDERS + SUPPORTS)).equilibrium([0.0, 1.0, 2.0])
    assert path.converged.all()
    # Both springs carry half; where each slider stands is not known.
    tips = path.q.sum(axis=1) + 0.02
    np.testing.assert_allclose(tips, [0.04, 0.045, 0.05], rtol=1e-9)
    assert path.stability.tolist() == ["neutral"] * 3
    assert path.iterations.sum() < 100


BECK = """
name = "beck"
planar = true
[bodies.rod]
kind = "rod"
length = "1 m"
radius = "1 cm"
young_modulus = "1 GPa"
poisson_ratio = 0.3
strain = { bend_y = "nodal_quadratic" }
elements = 10
gauss_points = 3
[wrenches.p]
body = "rod"
at = "tip"
force = { x = "-1 N" }
frame = "body"
input = true
"""


def test_beck_s_column_has_no_critical_load_in_statics() -> None:
    model = Model(parse(BECK))
    unit = 1e9 * np.pi / 4 * 1e-8
    loads = np.array([0.0, 10.0, 20.05, 37.0]) * unit
    path = model.equilibrium(loads)
    assert path.stability.tolist() == ["stable"] * 4
    elastic = model.engine.tangent(model.parameters, path.q[0], [0.0])
    for load in loads:
        tangent = model.engine.tangent(model.parameters, path.q[0], [load])
        assert np.abs(np.linalg.eigvals(np.linalg.solve(elastic, tangent)) - 1.0).max() < 0.1
