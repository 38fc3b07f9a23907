"""A motion that nothing holds goes with the first load: there a path begins, and no branch ends."""

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
