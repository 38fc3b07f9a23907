"""A half-space stops what is pushed into it, and what is wrong with it is said."""

from __future__ import annotations

import numpy as np
import pytest

from flexor.errors import InputError
from flexor.model import Model, parse
from flexor.model.separate import Separate

BLOCK = """
name = "block"
planar = true

[bodies.block]
kind = "link"
length = "5 cm"
radius = "1 cm"
joint = { kind = "prismatic", axis = "z", stiffness = "50 N/m" }

[spheres.foot]
points = [{ body = "block", at = "tip" }]

[obstacles.floor]
kind = "half-space"
spheres = ["foot"]
point = { z = "-2 cm" }
normal = [0, 0, 2]
stiffness = "200 N/m"

[wrenches.push]
body = "block"
at = "base"
force = { z = "-1 N" }
input = true
"""


@pytest.mark.parametrize("planar", [True, False])
def test_a_block_sinks_in_by_hookes_law(planar: bool) -> None:
    text = BLOCK if planar else BLOCK.replace("planar = true", "planar = false")
    model = Model(parse(text))
    path = model.equilibrium([0.0, 0.4, 3.0])
    assert path.stable.all()
    sunk = -(3.0 + 200.0 * 0.01) / 250.0  # 50 z - 200 (-1 cm - z) = -3 N
    np.testing.assert_allclose(path.q[:, 0], [0.0, -0.4 / 50.0, sunk], atol=1e-12)
    forces = path.contact_forces(2)
    np.testing.assert_allclose(forces.force, [[0.0, 0.0, 200.0 * (-0.01 - sunk)]], atol=1e-9)
    assert forces.second.tolist() == [-1]
    on_floor = path.obstacle_forces()["floor"]
    np.testing.assert_allclose(on_floor, [0.0, 0.0, 200.0 * (-0.01 - sunk)], atol=1e-9)
    assert path.to_dict()["obstacle_force"] == {"floor": on_floor.tolist()}
    assert path.pairs.tolist() == [0, 0, 0]


def test_bodies_that_do_nothing_to_one_another_share_a_floor() -> None:
    """The force on it is the sum over them, though each is solved on its own."""
    second = BLOCK[BLOCK.index("[bodies.block]") : BLOCK.index("[obstacles")]
    second = second.replace("block", "second").replace("foot", "other")
    second = second.replace("joint =", 'placement = { x = "20 cm" }\njoint =')
    text = BLOCK.replace("[obstacles", second + "[obstacles").replace(
        '["foot"]', '["foot", "other"]'
    )
    push = BLOCK[BLOCK.index("[wrenches.push]") :].replace("block", "second")
    push = push.replace("push", "load").replace("-1 N", "-2 N")
    model = Model(parse(text + push))
    assert isinstance(model.followed, Separate)
    path = model.equilibrium(np.array([[0.0, 0.0], [3.0, 1.0], [4.0, 0.1]]))
    assert path.stable.all()
    pressed = [np.maximum(-200.0 * (q + 0.01), 0.0) for q in path.q.T]
    np.testing.assert_allclose(path.obstacle_forces()["floor"], sum(pressed), atol=1e-9)
    assert (pressed[0][1:] > 0.0).all()
    assert pressed[1][1] > 0.0


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            'spheres = ["foot"]',
            'spheres = ["food"]',
            'obstacles.floor.spheres refers to the unknown sphere group "food" (did you mean '
            '"foot"?)',
        ),
        ('spheres = ["foot"]', 'spheres = ["foot", "foot"]', "obstacles.floor.spheres names"),
        ('spheres = ["foot"]', "spheres = []", "obstacles.floor.spheres"),
        ("normal = [0, 0, 2]", "normal = [0, 0, 0]", "obstacles.floor.normal has no direction"),
        (
            "normal = [0, 0, 2]",
            "normal = [0, 1, 2]",
            "obstacles.floor.normal is [0.0, 1.0, 2.0]: in a planar model it must lie in",
        ),
        ('kind = "half-space"', 'kind = "ball"', 'obstacles.floor has an unknown kind "ball"'),
        ('stiffness = "200 N/m"', 'stiffness = "0 N/m"', "obstacles.floor.stiffness is"),
        ('point = { z = "-2 cm" }', 'point = { y = "1 cm" }', "obstacles.floor.point.y is"),
    ],
)
def test_what_makes_no_obstacle_is_refused(old: str, new: str, sentence: str) -> None:
    assert old in BLOCK
    with pytest.raises(InputError) as caught:
        parse(BLOCK.replace(old, new))
    assert sentence in str(caught.value)
