"""Straps pull from surface to surface once they are taut."""

from __future__ import annotations

import numpy as np
import pytest

from flexor.errors import InputError
from flexor.model import Geometry, Model, parse

HUNG = """
name = "hung"
planar = true

[bodies.beam]
kind = "rod"
length = "10 cm"
radius = { base = "8 mm", tip = "6 mm" }
young_modulus = "1 MPa"
poisson_ratio = 0.5
placement = { z = "3 cm" }
strain = { extend_x = "nodal_linear" }
elements = 4
gauss_points = 2

[bodies.block]
kind = "link"
length = "10 cm"
radius = { base = "10 mm", tip = "12 mm" }
joint = { kind = "prismatic", axis = "z", stiffness = "50 N/m" }

[straps.band]
rod = "beam"
at = 0.5
to = { body = "block", at = 0.5 }
width = "2 cm"
stiffness_per_width = "10 N/cm^2"
slack = "4 mm"

[wrenches.weight]
body = "block"
at = "base"
force = { z = "-1 N" }
input = true

[design]
rod = "beam"
minimum_radius = "1 mm"
length_bounds = ["6 cm", "14 cm"]
radius_bounds = ["1 mm", "20 mm"]
"""
K = 0.02 * 1e5


def test_a_slack_strap_becomes_taut() -> None:
    path = Model(parse(HUNG)).equilibrium([0.0, 0.1, 3.0])
    assert path.stable.all()
    low = -(3.0 + K * 0.004) / (50.0 + K)
    np.testing.assert_allclose(path.q[:, -1], [0.0, -0.1 / 50.0, low], atol=1e-9)
    tension = K * (-low - 0.004)
    np.testing.assert_allclose(path.strap_forces()["band"], [0.0, 0.0, tension], atol=1e-6)
    assert path.to_dict()["strap_force"]["band"][2] == pytest.approx(tension)
    assert path.warnings == []


def test_pretension_and_limit() -> None:
    text = HUNG.replace('slack = "4 mm"', 'pretension = "2 N"\nlimit = "3 N"')
    path = Model(parse(text)).equilibrium([0.0, 3.0])
    # 50 q = 2 - K q at rest.
    np.testing.assert_allclose(path.q[:, -1], [2.0 / (50.0 + K), -1.0 / (50.0 + K)], rtol=1e-9)
    assert path.strap_forces()["band"][1] > 1.9
    path = Model(parse(text)).equilibrium([0.0, 5.0])
    (warning,) = path.warnings
    assert warning.startswith('strap "band" pulls with 4.')
    assert warning.endswith("from 5 N on beyond its limit of 3 N")


def test_its_end_follows_the_surface_of_a_design() -> None:
    model = Model(parse(HUNG))
    radius = np.full((1, model.X.size), 9e-3)
    geometry = Geometry(np.array([0.1]), radius, np.zeros_like(radius))
    path = model.evaluate(geometry, [0.0, 3.0])[0]
    # The underside is 2 mm lower than in the file, where S = 7 mm in the middle.
    low = -(3.0 + K * 0.006) / (50.0 + K)
    assert path.q[1, -1] == pytest.approx(low, rel=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            'at = 0.5\nto = { body = "block", at = 0.5 }',
            'at = 0.3\nto = { body = "block", loop = true }',
            "straps.band.at is 0.3: that of a loop must be an element boundary",
        ),
        ('width = "2 cm"\n', "", "straps.band.stiffness is missing: give it, or width and"),
        (
            'slack = "4 mm"',
            'pretension = "50 N"',
            'straps.band.pretension is "50 N": it must not stretch the strap to more than the 12 ',
        ),
        ('slack = "4 mm"', 'slack = "4 mm"\npretension = "1 N"', "straps.band.slack is given as"),
        ('body = "block", at', 'body = "blok", at', "straps.band.to.body refers to the unknown"),
    ],
)
def test_bad_straps(old: str, new: str, sentence: str) -> None:
    with pytest.raises(InputError) as raised:
        Model(parse(HUNG.replace(old, new)))
    assert str(raised.value).startswith(f"model: {sentence}")


LOOPED = """
name = "looped"
planar = true

[bodies.limb]
kind = "link"
length = "15 cm"
radius = "1 cm"

[bodies.suit]
kind = "rod"
length = "5 cm"
radius = "5 mm"
young_modulus = "100 GPa"
poisson_ratio = 0.5
placement = { z = "3 cm" }
joint = { kind = "prismatic", axis = "x", stiffness = "10 N/m" }
strain = { bend_y = "nodal_linear" }
elements = 4
gauss_points = 2

[straps.loop]
rod = "suit"
at = 0.5
to = { body = "limb", loop = true }
stiffness = "1 N/mm"
pretension = "2 N"

[wrenches.push]
body = "suit"
at = "base"
force = { x = "1 N" }
input = true
"""


@pytest.mark.parametrize("planar", [True, False])
def test_a_loop_slides_and_holds(planar: bool) -> None:
    model = Model(parse(LOOPED if planar else LOOPED.replace("planar = true", "planar = false")))
    path = model.equilibrium([0.0, 0.5, 1.0])
    assert path.stable.all()
    np.testing.assert_allclose(path.joint_angles[:, 0], [0.0, 0.05, 0.1], atol=1e-6)
    np.testing.assert_allclose(path.strap_forces()["loop"], 2.0, rtol=1e-3)
    # Axes 3 cm apart, surfaces 1.5 cm; 2 N stretch 1 N/mm by 2 mm.
    assert model.slot("loop.rest_length")[0] == pytest.approx(0.013)
    tapered = LOOPED.replace('radius = "1 cm"', 'radius = { base = "1 cm", tip = "2.5 cm" }')
    model = Model(parse(tapered))
    held = model.equilibrium([0.0])
    # The gap narrows by a tenth of the way x to the thick end: 10 N/m x = (2 N - 1 N/mm x/10)/10.
    assert held.joint_angles[0, 0] == pytest.approx(0.01, rel=1e-3)
    assert held.strap_forces()["loop"][0] == pytest.approx(1.0, rel=1e-3)


def test_a_loop_around_a_rod_is_refused() -> None:
    with pytest.raises(InputError) as caught:
        parse(LOOPED.replace('body = "limb", loop', 'body = "suit", loop'), source="bad.toml")
    assert str(caught.value) == (
        'bad.toml: straps.loop.to.body is "suit", which is a rod: a loop slides along a link.'
    )
