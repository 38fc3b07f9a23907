"""Derivatives of paths with friction against differences of the whole paths, on random designs."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.arrays import Array
from flexor.model import Model, parse
from flexor.model.derivatives import Derivatives, differentiate, last_step
from flexor.model.geometry import SlotValues

# A rod whose tip is pressed on a plane, half of it carried by a slider, and drawn to and fro.
ARM = """
name = "arm"
planar = {planar}

[bodies.arm]
kind = "rod"
length = "10 cm"
radius = "6 mm"
young_modulus = "1 MPa"
poisson_ratio = 0.5
joint = {{ kind = "fixed" }}
strain = {{ {strain} }}
elements = 2
gauss_points = 2

[bodies.hand]
kind = "link"
parent = "arm"
length = "2 cm"
radius = "5 mm"
joint = {{ kind = "revolute", axis = "y", stiffness = "0.02 N m/rad" }}

[bodies.plate]
kind = "link"
length = "1 cm"
radius = "1 mm"
placement = {{ z = "-8 mm" }}
joint = {{ kind = "prismatic", axis = "x", stiffness = "60 N/m" }}

[spheres.hand]
bodies = ["arm", "hand"]

[obstacles.desk]
kind = "half-space"
point = {{ body = "plate", at = "base" }}
normal = "z"
spheres = ["hand"]
stiffness = "2 kN/m"
friction = 0.4

[wrenches.press]
body = "hand"
at = "tip"
force = {{ z = "-1 N" }}
input = true

[wrenches.draw]
body = "plate"
at = "base"
force = {{ x = "1 N" }}
input = true
{more}
"""
SIDE = """
[wrenches.side]
body = "hand"
at = "tip"
force = { y = "1 N" }
input = true
"""
PLANAR = ARM.format(
    planar="true", strain='bend_y = "nodal_linear", extend_x = "nodal_linear"', more=""
)
SPATIAL = ARM.format(
    planar="false",
    strain='bend_y = "nodal_linear", bend_z = "nodal_linear", twist_x = "nodal_linear"',
    more=SIDE,
)
VARIED = (
    ("arm.length", 0.15),
    ("arm.young_modulus", 0.3),
    ("hand.length", 0.3),
    ("hand.radius_tip", 0.1),
    ("plate.translation", 0.1),
    ("plate.joint_stiffness", 0.5),
    ("desk.friction", 0.6),
    ("desk.friction_ratio", 0.3),
    ("draw.force", 0.1),
)
DESIGNS = 30
_STEP = 1e-5


def _slots(model: Model) -> tuple[np.ndarray, Array]:
    """Return the varied slots that are not zero, with their spread."""
    found = []
    for name, spread in VARIED:
        for slot in range(*model.engine.slots[name]):
            if model.parameters[slot] != 0.0:
                found.append((slot, spread))
    slots, spread = zip(*found, strict=True)
    return np.array(slots), np.array(spread)


def _loads(model: Model) -> Array:
    press = [0.0, 0.15, 0.3, 0.3, 0.3, 0.25, 0.3, 0.35]
    draw = [0.0, 0.0, 0.02, 0.2, 0.4, 0.1, -0.2, -0.1]
    side = [0.0, 0.0, 0.03, 0.03, 0.05, 0.02, 0.0, -0.04]
    return np.array([press, draw, side][: len(model.inputs)]).T


def _outputs(model: Model, slots: np.ndarray, values: Array, loads: Array) -> tuple[Array, Array]:
    paths = model.evaluate(SlotValues(slots, values), loads, 1)
    return paths.joint_angles[:, -1], (paths.converged & paths.stable).all(axis=1)


@pytest.mark.parametrize("text", [PLANAR, SPATIAL])
def test_derivatives_through_the_history_are_those_of_differences(text: str) -> None:
    model = Model(parse(text))
    slots, spread = _slots(model)
    random = np.random.default_rng(5)
    factors = 1.0 + spread * random.uniform(-1.0, 1.0, (DESIGNS, len(slots)))
    values = model.parameters[slots] * factors
    loads = _loads(model)
    paths = model.evaluate(SlotValues(slots, values), loads, 1)
    sliding = np.array([[points["slides"].any() for points in row] for row in paths.friction])
    assert sliding.any(axis=1).mean() > 0.7
    assert not sliding[:, 1:].all(axis=1).any()
    found = differentiate(paths, last_step(paths)[:-1], slots, 1)
    good = (paths.converged & paths.stable).all(axis=1)
    regular = (found.regularity == "regular").all(axis=1) & good
    assert regular.sum() > 0.8 * DESIGNS
    slopes = np.zeros_like(found.by_slots)
    for column, size in enumerate(np.abs(model.parameters[slots]) * _STEP):
        for sign in (-1.0, 1.0):
            moved = values.copy()
            moved[:, column] += sign * size
            ends, converged = _outputs(model, slots, moved, loads)
            regular &= converged
            slopes[:, :, column] += sign * ends / (2.0 * size)
    size = np.abs(slopes * model.parameters[slots]).max(axis=(0, 2))
    error = np.abs((found.by_slots - slopes) * model.parameters[slots]) / size[None, :, None]
    # Differences over a point that begins to slide are no derivatives.
    assert np.quantile(error[regular].max(axis=(1, 2)), 0.9) < 1e-5
    assert np.median(error[regular]) < 1e-7
    assert np.abs(found.by_loads).max() > 0.0
    _check_loads(model, found, values, slots, regular)


def _check_loads(
    model: Model, found: Derivatives, values: Array, slots: np.ndarray, regular: Array
) -> None:
    """An early load has its part in the end, where points have slid since."""
    design = int(np.flatnonzero(regular)[0])
    loads, step, size = _loads(model), 4, 1e-5
    ends = []
    for sign in (-1.0, 1.0):
        moved = loads.copy()
        moved[step, 1] += sign * size
        ends.append(_outputs(model, slots, values[design : design + 1], moved)[0][0])
    slope = (ends[1] - ends[0]) / (2.0 * size)
    np.testing.assert_allclose(
        found.by_loads[design, :, step, 1], slope, atol=1e-4 * np.abs(found.by_loads).max()
    )


def test_derivatives_of_skins_that_rub() -> None:
    model = flexor.load("pneumatic-finger", changes={"bodies.exosuit.friction": 0.4})
    loads = 60e3 * np.array([0.0, 0.2, 0.5, 0.8, 1.0, 0.7])[:, None]
    names = ("exosuit.length", "exosuit.skin.friction", "exosuit.skin.foundation")
    slots = np.array([model.engine.slots[name][0] for name in names])
    values = model.parameters[slots][None]
    paths = model.evaluate(SlotValues(slots, values), loads, 1)
    found = differentiate(paths, last_step(paths)[:-1], slots, 1)
    assert (found.regularity == "regular").all()
    for column, size in enumerate(1e-5 * values[0]):
        moved = values + size * np.eye(len(slots))[column] * np.array([[-1.0], [1.0]])
        ends, converged = _outputs(model, slots, moved, loads)
        assert converged.all()
        slope = (ends[1] - ends[0]) / (2.0 * size)
        np.testing.assert_allclose(found.by_slots[0, :, column], slope, rtol=2e-5)
