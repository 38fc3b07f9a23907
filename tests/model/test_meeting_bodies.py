"""A search or a long step meets what is in its way, however soft the joint that moves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from flexor.model import Model, parse

LINK = """
name = "link"
planar = {planar}
[bodies.a]
kind = "link"
length = "1 m"
radius = "2 cm"
joint = {{ {joint} }}
[spheres.a]
points = [{{ body = "a", at = "tip" }}]
[wrenches.w]
body = "a"
at = "tip"
input = true
{load}
"""
CAPSULE = """
[obstacles.o]
kind = "capsule"
spheres = ["a"]
axis = "y"
length = "0.2 m"
stiffness = "10 kN/m"
"""
CONE = """
[bodies.b]
kind = "link"
length = "1 m"
radius = "5 cm"
placement = { x = "0.3 m", z = "-0.6 m" }
[spheres.b]
bodies = ["b"]
[contacts.c]
first = "a"
second = "b"
shape = "round-cones"
stiffness = "10 kN/m"
"""
HINGE = 'kind = "revolute", axis = "y"'
SLIDE = 'kind = "prismatic", axis = "z"'
WEIGHT, MOMENT, FOLLOWER = (
    'force = { z = "-1 N" }',
    'moment = { y = "1 N*m" }',
    'force = { z = "-1 N" }\nframe = "body"',
)
STEPS: list[list[float]] = [[1.0], [0.0, 1.0], [0.0, 0.3, 0.6, 1.0]]


def link(joint: str, load: str = WEIGHT, planar: bool = True) -> str:
    return LINK.format(joint=joint, load=load, planar=str(planar).lower())


def place(x: str, z: str, radius: str) -> str:
    return CAPSULE + f'point = {{ x = "{x}", z = "{z}" }}\nradius = "{radius}"\n'


def rest(stiffness: float, torque: Any, gap: Any, lever: Any) -> float:
    """Angle at which torque, spring and contact balance, next to where the gap closes."""
    meets = brentq(gap, 0.0, 0.7, xtol=1e-14)
    return float(
        brentq(
            lambda t: torque(t) - stiffness * t + 1e4 * min(gap(t), 0.0) * lever(t),
            meets,
            meets + 5e-3,
            xtol=1e-14,
        )
    )


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("stiffness", [0.0, 0.05])
@pytest.mark.parametrize("load", [WEIGHT, MOMENT, FOLLOWER])
@pytest.mark.parametrize("solid", ["capsule", "spatial", "cone"])
def test_a_hinge_stops_at_what_is_in_its_way(
    solid: str, load: str, stiffness: float, steps: list[float]
) -> None:
    joint = HINGE + f', stiffness = "{stiffness} N*m/rad"'
    text = link(joint, load, solid != "spatial")
    text += CONE if solid == "cone" else place("0.75 m", "-0.65 m", "5 cm")
    path = Model(parse(text)).equilibrium(steps)
    assert path.stability[-1] == "stable"
    assert not path.events
    middle = np.array([0.75, 0.65])

    def tip(t: float) -> Any:
        return np.array([np.cos(t), np.sin(t)])

    def gap(t: float) -> float:
        away = np.linalg.norm(tip(t) - middle)
        return float(0.53 - np.sin(t) if solid == "cone" else away - 0.07)

    def lever(t: float) -> float:
        away = (middle - tip(t)) / np.linalg.norm(middle - tip(t))
        normal = np.array([0.0, 1.0]) if solid == "cone" else away
        return float(normal @ [-np.sin(t), np.cos(t)])

    expected = rest(stiffness, np.cos if load == WEIGHT else lambda _: 1.0, gap, lever)
    assert path.q[-1, 0] == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("radius", ["5 cm", "1 mm"])
@pytest.mark.parametrize("stiffness", [0.0, 1e-4, 1e-2])
@pytest.mark.parametrize("gap", [0.0, 0.5])
def test_a_slide_stops_at_what_is_in_its_way(
    gap: float, stiffness: float, radius: str, steps: list[float]
) -> None:
    reach = 0.02 + float(radius.split()[0]) * (1e-2 if "cm" in radius else 1e-3)
    text = link(SLIDE + f', stiffness = "{stiffness} N/m"') + place(
        "1 m", f"{-gap - reach} m", radius
    )
    path = Model(parse(text)).equilibrium(steps)
    assert path.stability[-1] == "stable"
    # -1 N - c z + k (-gap - z) = 0.
    expected = -(1.0 + 1e4 * gap) / (1e4 + stiffness)
    assert path.q[-1, 0] == pytest.approx(expected, abs=1e-9)


@pytest.mark.filterwarnings("ignore::flexor.errors.ModelWarning")
@pytest.mark.parametrize("steps", STEPS)
def test_contact_that_is_too_weak_is_passed(steps: list[float]) -> None:
    # 1 N against at most 10 N/m × 7 cm; the spring alone holds it at -10 m.
    text = link(SLIDE + ', stiffness = "0.1 N/m"') + place("1 m", "-0.5 m", "5 cm")
    path = Model(parse(text.replace("10 kN/m", "10 N/m"))).equilibrium(steps)
    assert path.q[-1, 0] == pytest.approx(-10.0, abs=1e-8)


def test_what_nothing_stops_is_unrestrained() -> None:
    text = link(HINGE, FOLLOWER) + place("0.3 m", "-0.3 m", "5 cm")
    path = Model(parse(text)).equilibrium([1.0])
    assert path.status == ["unrestrained"]


LEVER = """
name = "lever"
planar = true
[bodies.a]
kind = "link"
length = "100 mm"
radius = "{radius}"
joint = {{ kind = "revolute"{stiffness} }}
[spheres.t]
points = [{{ body = "a", at = "tip" }}]
[obstacles.o]
spheres = ["t"]
stiffness = "1e6 N/m"
{obstacle}
[wrenches.w]
body = "a"
at = "tip"
{load}
input = true
"""


@pytest.mark.parametrize("steps", [[0.0, 2.0], [0.0, 1.0, 2.0], list(np.linspace(0.0, 2.0, 41))])
def test_a_thin_body_in_the_way_of_a_long_lever_is_met(steps: list[float]) -> None:
    """Both are a hundredth of the lever thick; it turns by a right angle where nothing stops it."""
    capsule = '''kind = "capsule"
point = { x = "71.7 mm", z = "-66.8 mm" }
radius = "0.5 mm"
axis = "x"
length = "30 mm"'''
    load = 'force = { z = "-1 N" }'
    text = LEVER.format(radius="0.5 mm", stiffness="", obstacle=capsule, load=load)
    path = Model(parse(text)).equilibrium(steps)
    assert path.converged.all()
    # The tip rests 1 mm above the axis of the capsule, up to 1.4 micrometres of overlap.
    met = np.arcsin(0.668 - 0.01)
    assert path.joint_angles[-1, 0] == pytest.approx(met, abs=5e-5)


@pytest.mark.parametrize("steps", [[0.6], [0.2, 0.4, 0.6], list(np.linspace(0.0, 0.6, 31))])
def test_a_stiff_contact_that_is_only_grazed_is_met(steps: list[float]) -> None:
    """The overlap is at most 0.5 mm of 8 mm; the lever is held 24 degrees before its rest.

    The contact has no moment where it overlaps most, to which 0.4 N m turn the lever without it.
    """
    x, z = float(0.1075 * np.cos(0.8)), float(-0.1075 * np.sin(0.8))
    sphere = f'kind = "sphere"\npoint = {{ x = "{x!r} m", z = "{z!r} m" }}\nradius = "3 mm"'
    load = 'moment = { y = "1 N*m" }'
    stiffness = ', stiffness = "0.5 N*m/rad"'
    text = LEVER.format(radius="5 mm", stiffness=stiffness, obstacle=sphere, load=load)
    path = Model(parse(text)).equilibrium(steps)

    def gap(q: float) -> float:
        return float(np.hypot(0.1 * np.cos(q) - x, -0.1 * np.sin(q) - z))

    def moment(q: float, load: float) -> float:
        change = (gap(q + 1e-7) - gap(q - 1e-7)) / 2e-7
        return 0.5 * q - 1e6 * max(0.008 - gap(q), 0.0) * change - load

    assert path.converged.all()
    assert (path.stability == "stable").all()
    for load, angle in zip(steps, path.joint_angles[:, 0], strict=True):
        met = brentq(moment, -0.1, 0.79, args=(load,))
        assert angle == pytest.approx(met, abs=1e-6)
