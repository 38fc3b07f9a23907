"""Friction against closed forms: belts, strips, rolling cylinders, loops and steps of the load."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from flexor.arrays import Array
from flexor.model import Model, Path, parse

BELT = """
name = "belt"
planar = true

[bodies.belt]
kind = "rod"
length = "{length} m"
radius = "0.1 mm"
young_modulus = "100 GPa"
poisson_ratio = 0.5
joint = {{ kind = "free" }}
placement = {{ x = "{x} m", z = "{z} m", rotation = {{ y = "{turn} rad" }} }}
strain = {{ bend_y = "nodal_linear", extend_x = "nodal_linear" }}
reference_strain = {{ bend_y = "{curvature} 1/m" }}
elements = 40
gauss_points = 2

[spheres.belt]
bodies = ["belt"]

[obstacles.drum]
kind = "cylinder"
axis = "y"
radius = "{radius} m"
spheres = ["belt"]
stiffness = "200 kN/m"
friction = {friction}

[springs.held]
first = {{ body = "belt", at = "base" }}
second = {{ world = {{ x = "{hold_x} m", z = "{hold_z} m" }} }}
stiffness = "20 kN/m"
rest_length = "10 cm"

[wrenches.pull]
body = "belt"
at = "tip"
force = {{ x = "{pull_x} N", z = "{pull_z} N" }}
input = true
"""


def belt(angle: float, friction: float) -> Model:
    """A thin belt that lies on the top of a drum, held on the left and pulled on the right."""
    radius, half = 0.03, angle / 2.0
    along = radius + 1e-4
    x, z = -along * np.sin(half), along * np.cos(half)
    return Model(
        parse(
            BELT.format(
                length=along * angle,
                x=x,
                z=z,
                turn=-half,
                curvature=1.0 / along,
                radius=radius,
                friction=friction,
                hold_x=x - 0.1 * np.cos(half),
                hold_z=z - 0.1 * np.sin(half),
                pull_x=np.cos(half),
                pull_z=-np.sin(half),
            )
        )
    )


@pytest.mark.parametrize(("angle", "friction"), [(np.pi, 0.3), (np.pi, 0.5), (2.0, 0.4)])
def test_a_belt_on_a_drum_holds_by_the_capstan_equation(angle: float, friction: float) -> None:
    model = belt(angle, friction)
    loads = np.concatenate([[0.0, 0.5], np.linspace(1.0, 10.0, 10)])
    path = model.equilibrium(loads)
    assert path.converged.all()
    assert path.friction_forces().slides.all()
    held = path.spring_tension[-1, 0]
    assert loads[-1] / held == pytest.approx(np.exp(friction * angle), rel=0.01)


STRIP = """
name = "strip"
planar = true

[bodies.strip]
kind = "rod"
length = "10 cm"
radius = "1 mm"
young_modulus = "1000 GPa"
poisson_ratio = 0.5
joint = { kind = "prismatic", axis = "x", stiffness = "400 N/m" }
strain = { extend_x = "nodal_linear" }
elements = 4
gauss_points = 2

[spheres.strip]
bodies = ["strip"]

[obstacles.above]
kind = "half-space"
normal = [0, 0, -1]
point = { z = "0.9 mm" }
spheres = ["strip"]
stiffness = "10 kN/m"
friction = 0.25

[obstacles.below]
kind = "half-space"
normal = "z"
point = { z = "-0.9 mm" }
spheres = ["strip"]
stiffness = "10 kN/m"
friction = 0.25

[wrenches.pull]
body = "strip"
at = "tip"
force = { x = "1 N" }
input = true
"""


def test_a_strip_between_pads_is_dragged_with_both_normal_forces() -> None:
    model = Model(parse(STRIP))
    spheres = len(model.equilibrium(0.0)[0].spheres()["strip"])
    normal = 1e4 * 1e-4 * spheres
    drag = 2.0 * 0.25 * normal
    most = 3.0 * drag
    legs = [0.0, most, -most, most]
    lines = [np.linspace(a, b, 25)[:-1] for a, b in pairwise(legs)]
    loads = np.concatenate([*lines, [most]])
    path = model.equilibrium(loads)
    assert path.stable.all()
    forces = path.friction_forces()
    assert forces.slides.all()
    assert np.abs(forces.force[:, 0]).sum() == pytest.approx(drag, rel=1e-9)
    x = path.q[:, 0]
    # Sliding: K x = P - drag on the way out, P + drag on the way back, at the strip's base.
    assert 400.0 * x[24] == pytest.approx(most - drag, rel=1e-6)
    assert 400.0 * x[48] == pytest.approx(-most + drag, rel=1e-6)
    # Over the closed loop, the work of the pull is the area of the loop and what is dissipated.
    tip = np.array([path.frames(step)["strip"][-1, 0, 3] for step in range(len(path))])
    work = np.sum(0.5 * (loads[25:] + loads[24:-1]) * np.diff(tip[24:]))
    lost = path.dissipated[-1] - path.dissipated[24]
    assert path.energy[-1] == pytest.approx(path.energy[24], rel=1e-9)
    stroke = x[24] - x[48]
    # Each way the drag turns round over the elastic slip of all points and slides the rest.
    slip = normal * 0.25 / (2.0 / 3.0 * 1e4 * spheres)
    assert lost == pytest.approx(2.0 * drag * (stroke - 2.0 * slip), rel=1e-3)
    assert (np.diff(path.dissipated) > -1e-12).all()
    assert work == pytest.approx(lost, rel=0.02)


ROLLER = """
name = "roller"
planar = true

[bodies.plate]
kind = "link"
length = "1 cm"
radius = "1 mm"
joint = { kind = "prismatic", axis = "x", stiffness = "100 N/m" }

[bodies.roller]
kind = "link"
length = "1 mm"
radius = "1 cm"
joint = { kind = "free" }

[spheres.roller]
points = [{ body = "roller", at = "base" }]

[obstacles.above]
kind = "half-space"
point = { body = "plate", at = "base", offset = { z = "9.9 mm" } }
normal = [0, 0, -1]
spheres = ["roller"]
stiffness = "20 kN/m"
friction = 0.3

[obstacles.below]
kind = "half-space"
point = { z = "-9.9 mm" }
normal = "z"
spheres = ["roller"]
stiffness = "20 kN/m"
friction = 0.3

[wrenches.pull]
body = "plate"
at = "base"
force = { x = "1 N" }
input = true
"""


@pytest.mark.parametrize("steps", [5, 40])
def test_a_cylinder_between_plates_rolls_half_as_far(steps: int) -> None:
    path = Model(parse(ROLLER)).equilibrium(np.linspace(0.0, 3.0, steps + 1))
    assert path.converged.all()
    plate, turn = path.q[-1, :2]
    x, _, z = path.frames()["roller"][0, :3, 3]
    assert plate == pytest.approx(0.03, rel=1e-6)
    assert x == pytest.approx(0.015, rel=1e-6)
    # Rolling on the middle of the overlap of 0.1 mm, by more than a radian and a half.
    assert turn == pytest.approx(0.015 / (0.01 - 0.05e-3), rel=0.5 / steps**2)
    assert abs(z) < 1e-9
    assert not path.friction_forces().slides.any()
    assert path.dissipated[-1] == 0.0


BLOCK = """
name = "block"
planar = false

[bodies.carriage]
kind = "link"
length = "1 cm"
radius = "1 cm"
placement = { z = "1 cm" }
joint = { kind = "prismatic", axis = "z", stiffness = "1 N/m" }

[bodies.sledge]
kind = "link"
parent = "carriage"
length = "1 cm"
radius = "1 cm"
joint = { kind = "prismatic", axis = "x", stiffness = "300 N/m" }

[bodies.block]
kind = "link"
parent = "sledge"
length = "1 cm"
radius = "1 cm"
joint = { kind = "prismatic", axis = "y", stiffness = "300 N/m" }

[spheres.foot]
points = [{ body = "block", at = "base" }]

[obstacles.floor]
kind = "half-space"
normal = "z"
spheres = ["foot"]
stiffness = "20 kN/m"
friction = 0.4
stiffness_ratio = 0.5

[wrenches.press]
body = "block"
at = "base"
force = { z = "-1 N" }
input = true

[wrenches.pull_x]
body = "block"
at = "base"
force = { x = "1 N" }
input = true

[wrenches.pull_y]
body = "block"
at = "base"
force = { y = "1 N" }
input = true
"""


def spiral(steps: int) -> Array:
    """Loads that press more and more while the pull goes round."""
    t = np.linspace(0.0, 1.0, steps + 1)
    turn = 2.0 * np.pi * t
    pull = 4.0 * t
    loads = np.column_stack([2.0 + 3.0 * t, pull * np.cos(turn), pull * np.sin(turn)])
    return np.vstack([np.zeros(3), [2.0, 0.0, 0.0], loads[1:]])


def ends(steps: int) -> Path:
    path = Model(parse(BLOCK)).equilibrium(spiral(steps))
    assert path.converged.all()
    return path


def test_steps_converge_with_the_first_order_or_better() -> None:
    exact = ends(1280)
    counts = [10, 20, 40, 80]
    for pick in (lambda path: path.q[-1, 1:], lambda path: path.dissipated[-1]):
        off = [float(np.linalg.norm(pick(ends(n)) - pick(exact))) for n in counts]
        slope = -np.polyfit(np.log(counts), np.log(off), 1)[0]
        assert slope > 0.9, off


def test_what_is_dissipated_balances_the_work_of_the_loads() -> None:
    steps = 400
    path, loads = ends(steps), spiral(steps)
    every = [path.frames(step)["block"][0, :3, 3] for step in range(len(path))]
    places = np.array(every)[:, [2, 0, 1]] * [-1.0, 1.0, 1.0]
    work = np.sum(0.5 * (loads[1:] + loads[:-1]) * np.diff(places, axis=0))
    # The energy includes that of the loads: without them it is what springs and contacts store.
    stored = path.energy[-1] + np.sum(loads[-1] * places[-1])
    assert path.dissipated[-1] > 0.1 * stored
    assert work == pytest.approx(stored + path.dissipated[-1], rel=2e-3)
