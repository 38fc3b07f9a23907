"""Skins that rub on obstacles: a bar that sticks and slides, and derivatives along paths."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.model import Model, parse
from flexor.model.derivatives import differentiate, last_step
from flexor.model.geometry import SlotValues

# A skin of 2 mm with a modulus of 0.4 MPa.
K_F = 0.4e6 / 2e-3
RADIUS, LENGTH, SPRING = 8e-3, 60e-3, 300.0

BAR = f"""
name = "bar"
planar = PLANAR

[bodies.carriage]
kind = "link"
length = "1 cm"
radius = "1 mm"
joint = {{ kind = "prismatic", axis = "z", stiffness = "1 N/m" }}

[bodies.bar]
kind = "link"
parent = "carriage"
length = "{LENGTH!r} m"
radius = "{RADIUS!r} m"
skin = {{ modulus = "0.4 MPa", thickness = "2 mm" }}
joint = {{ kind = "prismatic", axis = "x", stiffness = "{SPRING!r} N/m" }}

[obstacles.floor]
OBSTACLE
friction = 0.4

[wrenches.press]
body = "bar"
at = 0.5
force = {{ z = "-1 N" }}
input = true

[wrenches.pull]
body = "bar"
at = 0.5
force = {{ x = "1 N" }}
input = true
"""
PLANE = 'kind = "half-space"\nnormal = "z"\npoint = { z = "-8.5 mm" }'
BARREL = 'kind = "cylinder"\naxis = "x"\nradius = "4 cm"\npoint = { z = "-48.5 mm" }'


@pytest.mark.parametrize("planar", [True, False])
def test_a_bar_sticks_and_slides_on_a_plane(planar: bool) -> None:
    text = BAR.replace("OBSTACLE", PLANE).replace("PLANAR", str(planar).lower())
    loads = {"press": [0.0, 5.0, 5.0, 5.0, 5.0, 5.0], "pull": [0.0, 0.0, 1.0, 4.0, 3.0, -1.0]}
    path = Model(parse(text)).equilibrium(loads)
    assert path.stable.all()
    z, x = path.q.T
    force = path.obstacle_forces()["floor"]
    np.testing.assert_allclose(force[1:], 5.0 + z[1:], rtol=1e-9)
    # It sticks with two thirds of the normal stiffness of strip and round ends.
    depth = -z[2] - 0.5e-3
    strip = 2.0 * K_F * np.sqrt(2.0 * RADIUS * depth) * LENGTH
    stiffness = 2.0 / 3.0 * (strip + 2.0 * np.pi * K_F * RADIUS * depth)
    assert x[2] == pytest.approx(1.0 / (SPRING + stiffness), rel=1e-9)
    # It slides, sticks as the pull falls, and slides back.
    assert SPRING * x[3] == pytest.approx(4.0 - 0.4 * force[3], rel=1e-9)
    assert x[4] == pytest.approx(x[3] - 1.0 / (SPRING + stiffness), rel=1e-9)
    assert SPRING * x[5] == pytest.approx(-1.0 + 0.4 * force[5], rel=1e-9)
    rubs = path.friction_forces(3)
    assert set(rubs.name) == {"floor"} and rubs.slides.all()
    assert rubs.limit.sum() == pytest.approx(0.4 * force[3], rel=1e-9)
    assert not path.friction_forces(4).slides.any()
    # Turning round gives back and takes up again the elastic slip; the rest of the way is lost.
    elastic = 0.4 * force[3] / stiffness
    way = x[3] - elastic, x[3] - x[5] - 2.0 * elastic
    assert path.dissipated[3] == pytest.approx(0.4 * force[3] * way[0], rel=1e-3)
    assert path.dissipated[5] - path.dissipated[3] == pytest.approx(
        0.4 * force[3] * way[1], rel=1e-3
    )


@pytest.mark.parametrize(("planar", "obstacle"), [(True, PLANE), (False, PLANE), (False, BARREL)])
def test_derivatives_of_bars_are_those_of_differences(planar: bool, obstacle: str) -> None:
    text = BAR.replace("OBSTACLE", obstacle).replace("PLANAR", str(planar).lower())
    model = Model(parse(text))
    names = ["bar.length", "bar.radius_base", "bar.radius_tip", "bar.translation"]
    names += ["floor.friction", "floor.offset", "bar.joint_stiffness"]
    names += [name for name in model.engine.slots if name.startswith("floor.") and "skin" in name]
    names += ["floor.radius"] if obstacle == BARREL else []
    names += [name for name in model.engine.slots if name.endswith("foundation")]
    slots = np.unique([i for name in names for i in range(*model.engine.slots[name])])
    slots = slots[model.parameters[slots] != 0.0]
    press = [0.0, 4.0, 5.0, 5.0, 5.0, 6.0, 5.5]
    pull = [0.0, 0.0, 1.0, 4.0, 3.0, -1.0, 0.0]
    loads = np.array([press, pull]).T
    values = model.parameters[slots][None]
    paths = model.evaluate(SlotValues(slots, values), loads, 1)
    found = differentiate(paths, last_step(paths)[:-1], slots, 1)
    assert (found.regularity == "regular").all()
    seen = 0
    for column, size in enumerate(1e-5 * np.abs(values[0])):
        moved = values + size * np.eye(len(slots))[column] * np.array([[-1.0], [1.0]])
        ends = model.evaluate(SlotValues(slots, moved), loads, 1)
        assert (ends.converged & ends.stable).all()
        slope = np.diff(ends.joint_angles[:, -1], axis=0)[0] / (2.0 * size)
        scale = np.abs(ends.joint_angles[0, -1]).max() / np.abs(values[0, column])
        np.testing.assert_allclose(
            found.by_slots[0, :, column], slope, rtol=1e-5, atol=1e-7 * scale
        )
        seen += int(np.abs(slope).max() > 1e-4 * scale)
    assert seen >= 5


def test_a_grasp_that_rubs_turns_back_on_another_way() -> None:
    smooth = flexor.load("grasp", changes={"obstacles.cylinder.friction": 0.0})
    rough = flexor.load("grasp", changes={"obstacles.cylinder.friction": 0.5})
    loads = 6e3 * np.array([0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 8.0, 6.0, 4.0, 2.0, 0.0])
    plain, path = smooth.equilibrium(loads), rough.equilibrium(loads)
    assert path.converged.all() and path.stable.all()
    assert plain.friction is None and (plain.dissipated == 0.0).all()
    bend = path.joint_angles.sum(axis=1)
    assert (bend[2:5] < bend[8:5:-1]).all()
    assert bend[2] < plain.joint_angles[2].sum() < bend[8]
    assert abs(bend[-1]) < 1e-3
    rubs = path.friction_forces(5)
    assert (np.linalg.norm(rubs.force, axis=1) <= rubs.limit * (1.0 + 1e-6)).all()
    assert rubs.slides.any() and not rubs.slides.all()
    assert (np.diff(path.dissipated) > -1e-12).all() and path.dissipated[-1] > 0.0
    held = rough.equilibrium([*loads[:5], *[loads[4]] * 20])
    assert (held.q[4:] == held.q[4]).all()


def test_derivatives_of_a_grasp_that_rubs_are_those_of_differences() -> None:
    model = flexor.load("grasp", changes={"obstacles.cylinder.friction": 0.5})
    names = ("exosuit.length", "cylinder.friction", "cylinder.radius", "ph_2.radius_tip")
    slots = np.array([model.engine.slots[name][0] for name in names])
    loads = 60e3 * np.array([0.0, 0.3, 0.6, 0.8, 0.7])[:, None]
    values = model.parameters[slots][None]
    paths = model.evaluate(SlotValues(slots, values), loads, 1)
    assert any(points["slides"].any() for points in paths.friction[0])
    found = differentiate(paths, last_step(paths)[:-1], slots, 1)
    assert (found.regularity == "regular").all()
    for column, size in enumerate(1e-5 * values[0]):
        moved = values + size * np.eye(len(slots))[column] * np.array([[-1.0], [1.0]])
        ends = model.evaluate(SlotValues(slots, moved), loads, 1)
        assert ends.converged.all()
        slope = np.diff(ends.joint_angles[:, -1], axis=0)[0] / (2.0 * size)
        largest = np.abs(slope).max()
        np.testing.assert_allclose(found.by_slots[0, :, column], slope, atol=1e-4 * largest)
