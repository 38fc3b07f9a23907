"""Outlines of obstacles, and guides of tendons."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.model import Model, parse
from flexor.plot.reading import read_scene

TEXT = """
name = "lever"
planar = true

[bodies.lever]
kind = "link"
length = "10 cm"
radius = "5 mm"
joint = { kind = "revolute", stiffness = "0.1 N*m/rad" }

[bodies.ball]
kind = "link"
length = "1 cm"
radius = "5 mm"
placement = { z = "20 cm" }

[spheres.ball]
points = [{ body = "ball", at = "tip" }]

[obstacles.thing]
spheres = ["ball"]
stiffness = "2 kN/m"
SHAPE

[wrenches.turn]
body = "lever"
at = "base"
moment = { y = "1 N*m" }
input = true
"""
ON_TIP = 'point = { body = "lever", at = "tip" }\n'


@pytest.mark.parametrize(
    ("shape", "distance"),
    [
        ('kind = "sphere"\nradius = "2 cm"\n', lambda r: np.hypot(*r.T)),
        ('kind = "cylinder"\naxis = "y"\nradius = "2 cm"\n', lambda r: np.hypot(*r.T)),
        (
            'kind = "box"\nsize = { x = "4 cm", z = "4 cm" }\n',
            lambda r: np.abs(r).max(axis=1),
        ),
    ],
)
def test_an_outline_moves_with_the_body_that_carries_it(shape: str, distance) -> None:  # type: ignore[no-untyped-def]
    path = Model(parse(TEXT.replace("SHAPE", ON_TIP + shape))).equilibrium([0.0, 0.05])
    (line,) = read_scene(path).lines
    angle = path.q[-1, 0]
    assert angle == pytest.approx(0.5)
    x, z = np.array([np.cos(angle), -np.sin(angle)]), np.array([np.sin(angle), np.cos(angle)])
    r = line.points[:, [0, 2]] - 0.1 * x
    local = np.stack([r @ x, r @ z], axis=1)
    np.testing.assert_allclose(distance(local), 0.02, rtol=1e-9)
    np.testing.assert_allclose(np.ptp(local, axis=0), 0.04, rtol=1e-9)


def test_guides_are_drawn_where_tendons_pass_bodies() -> None:
    path = flexor.load("tendon-glove").equilibrium()
    found = read_scene(path).lines
    guides = [each for each in found if each.label == "guide of a tendon"]
    tendon = np.concatenate([each.points for each in found if each.label == "tendon"])
    assert len(guides) == 5 + 5
    for each in guides:
        middle = each.points.mean(axis=0)
        assert np.linalg.norm(tendon - middle, axis=1).min() < 1e-9
