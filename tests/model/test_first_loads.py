"""The first load, at which a path begins.

A motion that nothing holds goes with it, and no branch ends there. Equilibria under loads without a
potential are found as well.
"""

from __future__ import annotations

import numpy as np
import pytest

from flexor.model import Model, parse

CHAIN = """
name = "chain"
planar = true
[bodies.a]
kind = "link"
length = "10 cm"
radius = "2 mm"
joint = {{ kind = "revolute"{first} }}
[bodies.b]
kind = "link"
parent = "a"
length = "6 cm"
radius = "2 mm"
joint = {{ kind = "revolute"{second} }}
[wrenches.pull]
body = "b"
at = "tip"
force = {{ x = "{x!r} N", z = "{z!r} N" }}
input = true
"""
HELD = ', stiffness = "0.05 N*m/rad"'


def chain(angle: float, first: str, second: str) -> Model:
    """Return two links that are pulled in the direction at this angle, in degrees."""
    x, z = np.cos(np.radians(angle)), -np.sin(np.radians(angle))
    return Model(parse(CHAIN.format(first=first, second=second, x=float(x), z=float(z))))


@pytest.mark.parametrize("angle", [10, 90, 150, 179, 180, -170])
@pytest.mark.parametrize("steps", [1, 3, 30])
@pytest.mark.parametrize("held", [("", ""), ("", HELD), (HELD, "")])
def test_a_free_hinge_turns_without_an_event(held: tuple[str, str], steps: int, angle: int) -> None:
    path = chain(angle, *held).equilibrium(2.0 * np.arange(1, steps + 1) / steps)
    assert path.converged.all()
    assert (path.stability == "stable").all()
    if held[0] and angle == 180:
        # A column: it buckles at the stiffness of the hinge over its length.
        assert [event.kind for event in path.events] == ["bifurcation"]
        assert path.events[0].force == pytest.approx(0.5, rel=1e-3)
    else:
        assert not path.events
    pull = np.array([np.cos(np.radians(angle)), 0.0, -np.sin(np.radians(angle))])
    if held[0]:
        # The first hinge yields, and the second link lies along the force.
        assert np.cos(path.q[-1].sum() - np.radians(angle)) == pytest.approx(1.0, abs=1e-12)
    else:
        # The line from the first hinge to the tip does.
        tip = path.frames(steps - 1)["b"][-1][:3, 3]
        assert pull @ tip == pytest.approx(np.linalg.norm(tip), rel=1e-12)


def test_a_hinge_that_the_load_turns_over_on_the_way_snaps() -> None:
    # As the force goes through zero, the link that hung along it stands against it.
    for loads in ([1.0, -1.0], [1.0, 0.5, -0.5, -1.0]):
        path = chain(90, "", "").equilibrium(loads)
        assert path.converged.all()
        assert [event.kind for event in path.events] == ["snap"]
        assert path.events[0].force == pytest.approx(0.0, abs=0.01)


def test_a_snap_beside_a_free_hinge_is_an_event() -> None:
    # ½z² + 5(|z| − 0.3)² − Fz: the branch ends at z = 0, F = −3. Nothing acts on the second link.
    text = """
name = "slide"
planar = true
[bodies.a]
kind = "link"
length = "1 m"
radius = "0.2 m"
joint = { kind = "prismatic", axis = "z", stiffness = "1 N/m" }
[bodies.b]
kind = "link"
parent = "a"
length = "0.1 m"
radius = "1 cm"
joint = { kind = "revolute" }
[springs.s]
first = { body = "a", at = "tip" }
second = { world = { x = "1 m" } }
stiffness = "10 N/m"
rest_length = "0.3 m"
[wrenches.w]
body = "b"
at = "base"
force = { z = "1 N" }
input = true
"""
    path = Model(parse(text)).equilibrium([0.0, -2.9, -3.1])
    assert path.stability[-1] == "neutral"
    assert [event.kind for event in path.events] == ["snap"]
    assert path.events[0].force == pytest.approx(-3.0, rel=2e-3)


RING = """
name = "ring"
planar = true
[bodies.rod]
kind = "rod"
length = "314.159265358979 mm"
radius = "1 mm"
young_modulus = "10 MPa"
poisson_ratio = 0.45
joint = { kind = "prismatic", axis = "x" }
reference_strain = { bend_y = "20 1/m" }
strain = { bend_y = "nodal_quadratic", extend_x = "nodal_quadratic", shear_z = "nodal_quadratic" }
elements = 16
gauss_points = 3
[springs.a]
first = { body = "rod", at = "tip" }
second = { body = "rod", at = "base" }
stiffness = "100 N/m"
[springs.b]
first = { body = "rod", at = "tip", offset = { z = "20 mm" } }
second = { body = "rod", at = "base", offset = { z = "20 mm" } }
stiffness = "100 N/m"
[wrenches.p]
body = "rod"
at = 0.5
force = { z = "1 N" }
input = true
"""


@pytest.mark.parametrize("loads", [[0.0, 0.5], [0.0, 0.25, 0.5], [0.5]])
def test_a_slide_that_the_load_does_not_drive_stays(loads: list[float]) -> None:
    """Also where the rest of the structure is so soft that the end of the branch is looked for."""
    path = Model(parse(RING)).equilibrium(loads)
    assert path.converged.all()
    np.testing.assert_allclose(path.q[:, 0], 0.0, atol=1e-9)


FOLLOWERS = """
name = "followers"
gravity = {{ z = "-9.81 m/s^2" }}
[bodies.a]
kind = "rod"
length = "{length} cm"
{rod}
[bodies.b]
kind = "rod"
parent = "a"
length = "20 cm"
{rod}
[springs.s]
first = {{ body = "b", at = "tip" }}
second = {{ world = {{ x = "20 cm", y = "10 cm", z = "10 cm" }} }}
stiffness = "{stiffness} N/m"
[wrenches.m]
body = "b"
at = "tip"
moment = {{ x = "2 N*mm", y = "2 N*mm", z = "2 N*mm" }}
frame = "body"
[wrenches.f]
body = "b"
at = "tip"
force = {{ x = "1 N" }}
input = true
"""
SOFT_ROD = """
radius = "5 mm"
young_modulus = "1 MPa"
poisson_ratio = 0.45
density = "1000 kg/m^3"
strain = { twist_x = "nodal_linear", bend_y = "nodal_linear", bend_z = "nodal_linear" }
elements = 6
gauss_points = 2
"""


@pytest.mark.parametrize("stiffness", [2, 20])
def test_newton_steps_that_creep_to_no_equilibrium_are_given_up(stiffness: int) -> None:
    """The norm of the residual has minima above zero; small changes decide what ends there."""
    tips = []
    for length in (19.0, 19.5, 20.0, 20.5, 21.0):
        text = FOLLOWERS.format(length=length, stiffness=stiffness, rod=SOFT_ROD)
        path = Model(parse(text)).equilibrium([0.0], max_iterations=5000)
        assert path.status[0] == "converged"
        assert path.stability[0] == "stable"
        tips.append(path.frames(0)["b"][-1][:3, 3])
    # The same equilibrium for all: it moves little with the length.
    assert np.linalg.norm(np.diff(tips, axis=0), axis=1).max() < 0.01


HANGING = """
name = "hanging"
gravity = { z = "-9.81 m/s^2" }
[bodies.rod]
kind = "rod"
length = "39.86 cm"
radius = "4.62 mm"
young_modulus = "1.584 MPa"
poisson_ratio = 0.45
density = "1272 kg/m^3"
strain = { twist_x = "nodal_linear", bend_y = "nodal_linear", bend_z = "nodal_linear" }
elements = 6
gauss_points = 2
[springs.s]
first = { body = "rod", at = "tip" }
second = { world = { x = "-0.3142 m", y = "0.1065 m", z = "0.1420 m" } }
stiffness = "0.424 N/m"
rest_length = "0.1048 m"
[wrenches.m]
body = "rod"
at = "tip"
moment = { x = "-10.95 N*mm", y = "-4.5 N*mm", z = "-1.56 N*mm" }
frame = "body"
"""
INPUT = "input = true\n"
OTHER_INPUT = """
[wrenches.f]
body = "rod"
at = "tip"
force = { x = "1 N" }
input = true
"""


def test_followers_under_which_the_rod_at_rest_never_settles_are_added_in_parts() -> None:
    """The overdamped motion from the straight rod ends in a cycle."""
    at_once = Model(parse(HANGING + OTHER_INPUT)).equilibrium([0.0, 0.01])
    wound_up = Model(parse(HANGING + INPUT)).equilibrium([1.0])
    assert at_once.converged.all()
    assert at_once.stability[0] == "stable"
    np.testing.assert_allclose(at_once.q[0], wound_up.q[0], rtol=1e-6, atol=1e-6)
    # The path goes on with the whole moment.
    both = Model(parse(HANGING + INPUT + OTHER_INPUT))
    pulled = both.equilibrium({"m": [1.0, 1.0], "f": [0.0, 0.01]})
    np.testing.assert_allclose(at_once.q[1], pulled.q[1], rtol=1e-6, atol=1e-6)


def test_a_search_without_hope_ends_early() -> None:
    shorter = HANGING.replace("39.86 cm", "33 cm").replace("-10.95", "-12.16")
    path = Model(parse(shorter + INPUT)).equilibrium([1.0])
    assert path.status[0] == "stalled"
    assert path.iterations[0] < 5000
