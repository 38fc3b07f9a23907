"""Bodies with a skin on obstacles: against integrals written out here, and exact derivatives."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from flexor.errors import InputError
from flexor.model import Model, parse

# A skin of 2 mm with a modulus of 0.4 MPa.
K_F = 0.4e6 / 2e-3
RADIUS, LENGTH, SPRING = 8e-3, 60e-3, 50.0

BAR = f"""
name = "bar"
planar = PLANAR

[bodies.bar]
kind = "link"
length = "{LENGTH!r} m"
radius = "{RADIUS!r} m"
skin = {{ modulus = "0.4 MPa", thickness = "2 mm" }}
joint = {{ kind = "prismatic", axis = "z", stiffness = "{SPRING!r} N/m" }}

[obstacles.stop]
OBSTACLE

[wrenches.push]
body = "bar"
at = 0.5
force = {{ z = "-1 N" }}
input = true
"""
CYLINDER = """
kind = "cylinder"
axis = "y"
radius = "2 cm"
point = { x = "31 mm", z = "-29 mm" }
"""


def pushed(obstacle: str, planar: bool) -> float:
    """Return where a push of 3 N along -z brings a bar [m]."""
    text = BAR.replace("OBSTACLE", obstacle).replace("PLANAR", str(planar).lower())
    path = Model(parse(text)).equilibrium([0.0, 3.0])
    assert path.stable.all()
    assert path.obstacle_forces()["stop"][0] == 0.0
    # Of the forces on the obstacle, the part along z.
    held = path.contact_forces(1).force[:, 2].sum()
    assert held == pytest.approx(3.0 + SPRING * path.joint_angles[1, 0], rel=1e-9)
    return float(path.joint_angles[1, 0])


def strip(depth: float, curvature: float) -> float:
    """Return the force per length of an elastic foundation [N/m]."""
    return 4.0 / 3.0 * K_F * np.sqrt(2.0 / curvature) * max(depth, 0.0) ** 1.5


@pytest.mark.parametrize("planar", [True, False])
def test_a_bar_lies_on_a_plane(planar: bool) -> None:
    """The cylinder between its ends and half of a sphere at both press with their overlap."""
    plane = 'kind = "half-space"\nnormal = "z"\npoint = { z = "-9 mm" }'
    place = pushed(plane, planar)
    depth = -place - 1e-3
    expected = LENGTH * strip(depth, 1.0 / RADIUS) + np.pi * K_F * RADIUS * depth**2
    assert SPRING * place + 3.0 == pytest.approx(expected, rel=1e-9)


def test_the_pressure_on_an_obstacle_counts_with_its_place() -> None:
    plane = 'kind = "half-space"\nnormal = "z"\npoint = { z = "-9 mm" }'
    text = BAR.replace("OBSTACLE", plane).replace("PLANAR", "true")
    path = Model(parse(text)).equilibrium([0.0, 3.0])
    depth = -path.joint_angles[1, 0] - 1e-3
    assert path.max_contact_pressure[0] == 0.0
    assert path.max_contact_pressure[1] == pytest.approx(K_F * depth, rel=1e-9)
    assert path.contact_quantities == ("max_contact_pressure",)
    found = path[1].extremes()["max_contact_pressure"]
    assert (found.body, found.on) == ("bar", "stop")
    assert found.value == path.max_contact_pressure[1]
    assert path.contact_forces(1).second.tolist() == [-1] * len(path.contact_forces(1).second)


@pytest.mark.parametrize("planar", [True, False])
def test_a_bar_lies_across_a_cylinder(planar: bool) -> None:
    """Where it is flat across the bar; the quadrature along the bar has an error of 2 %."""

    def excess(place: float) -> float:
        def depth(x: float) -> float:
            return RADIUS + 0.02 - np.hypot(x - 0.031, place + 0.029)

        def lift(x: float) -> float:
            return (
                strip(depth(x), 1.0 / RADIUS) * (place + 0.029) / np.hypot(x - 0.031, place + 0.029)
            )

        reach = np.sqrt(max((RADIUS + 0.02) ** 2 - (place + 0.029) ** 2, 0.0))
        return 3.0 + SPRING * place - quad(lift, 0.031 - reach, 0.031 + reach)[0]

    expected = brentq(excess, -0.02, -0.001)
    place = pushed(CYLINDER, planar)
    assert place + 1e-3 == pytest.approx(expected + 1e-3, rel=0.015)


def test_a_skin_of_the_obstacle_adds_its_softness() -> None:
    """Two skins one on the other are one of their thickness."""
    plane = 'kind = "half-space"\nnormal = "z"\npoint = { z = "-9 mm" }\n'
    soft = plane + 'skin = { modulus = "0.4 MPa", thickness = "6 mm" }'
    place = pushed(soft, True)
    depth = -place - 1e-3
    stiff = LENGTH * strip(depth, 1.0 / RADIUS) + np.pi * K_F * RADIUS * depth**2
    assert SPRING * place + 3.0 == pytest.approx(0.25 * stiff, rel=1e-9)


def test_a_rod_presses_with_its_underside() -> None:
    """A straight rod of solid section that sinks into a plane as a whole, without ends."""
    text = """
name = "strip"
planar = true

[bodies.carrier]
kind = "link"
length = "1 mm"
radius = "1 mm"
joint = { kind = "prismatic", axis = "z", stiffness = "50 N/m" }

[bodies.strip]
kind = "rod"
parent = "carrier"
length = "10 cm"
radius = "8 mm"
young_modulus = "1e5 MPa"
poisson_ratio = 0.3
strain = { bend_y = "nodal_linear" }
elements = 4
gauss_points = 2
skin = { modulus = "0.4 MPa", thickness = "2 mm" }

[obstacles.stop]
kind = "half-space"
normal = "z"
point = { z = "-9 mm" }

[wrenches.push]
body = "carrier"
at = "tip"
force = { z = "-1 N" }
input = true
"""
    path = Model(parse(text)).equilibrium([0.0, 3.0])
    assert path.stable.all()
    depth = -path.joint_angles[1, 0] - 1e-3
    force = path.obstacle_forces()["stop"][1]
    # The rod, stiff as it is, does not bend by a hundredth of that.
    assert force == pytest.approx(0.1 * strip(depth, 1.0 / RADIUS), rel=1e-2)
    found = path.contact_forces(1)
    assert found.pressure.max() == pytest.approx(K_F * depth, rel=1e-2)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("", "obstacles.stop touches nothing: no body has a skin, and it names no spheres: give"),
        ('stiffness = "1 N/m"', "obstacles.stop.stiffness is of no use without spheres"),
        ('spheres = ["tip"]', "obstacles.stop.stiffness is missing: spheres press on it with a"),
        (
            'spheres = ["tip"]\nstiffness = "1 N/m"\n'
            'skin = { modulus = "1 MPa", thickness = "1 mm" }',
            "obstacles.stop.skin does not act on spheres: leave out one of both",
        ),
    ],
)
def test_what_nothing_can_touch_is_refused(change: str, said: str) -> None:
    bare = "\n".join(line for line in BAR.splitlines() if not line.startswith("skin"))
    plane = f'kind = "half-space"\nnormal = "z"\npoint = {{ z = "-9 mm" }}\n{change}'
    spheres = '[spheres.tip]\nbodies = ["bar"]\n\n[wrenches'
    text = bare.replace("OBSTACLE", plane).replace("PLANAR", "true").replace("[wrenches", spheres)
    with pytest.raises(InputError) as error:
        parse(text)
    assert said in str(error.value)
