"""Moulds: what they leave free is the body, and what cannot be cast is refused."""

from __future__ import annotations

from math import pi, radians, tan
from typing import Any

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.export import BodyOptions, Device, MouldOptions, body, device_of, mould
from flexor.export.instructions import steps
from flexor.export.masses import portions
from flexor.export.sheets import sheets
from flexor.export.silicone import silicone
from tests.export.rods import HALF, TUBE, air, device


@pytest.fixture(scope="module")
def finger() -> Device:
    return device_of(flexor.load("pneumatic-finger"))


def test_the_parts_of_a_mould(finger: Device) -> None:
    made = mould(finger)
    assert list(made.parts()) == [
        *("lower", "upper", "end-base", "end-tip", "core-chamber", "lid-base", "lid-tip")
    ]
    for solid in made.printed().values():
        assert solid.volume() > 0.0
        assert solid.bounding_box()[:3] == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    # The lower half is a plate below the sloping floor; the bore widens towards the base.
    assert made.lower.bounding_box()[2] == pytest.approx(-14.0)
    assert made.cores[0].pull == "base"
    assert made.cores[0].stretch == 0.0


def test_what_is_poured(finger: Device) -> None:
    portion = {each.name: each for each in portions(body(finger))}
    cap = 0.5 * pi * 13.5**2 + 27.0 * 2.5
    tube = pi * 1.5**2
    assert portion["cap at the base"].volume == pytest.approx(5e-9 * (cap - tube), rel=2e-3)
    # Without the fabric: the integral over the sections and what the ears add.
    bare = 11.197e-6
    assert portion["body"].volume > bare
    assert portion["body"].mass == pytest.approx(1080.0 * portion["body"].volume, rel=1e-9)


def test_the_silicone_is_named(finger: Device) -> None:
    """By its name in the library, with where it is from; one of the model as what it is."""
    said = " ".join(silicone(body(finger)))
    assert 'Dragon Skin 30 silicone ("silicone" in the model), 1080 kg/m³' in said
    assert "Soft Robotics Materials Database" in said and "1 part A to 1 part B" in said
    plain = {"silicone": {"kind": "linear", "young_modulus": "0.5 MPa"}}
    (own,) = silicone(body(device({"kind": "rectangular", "ratio": 1.25}, materials=plain)))
    assert "of the model" in own and "does not say which product" in own


def test_shrinkage_enlarges_the_cavity_and_draft_widens_it() -> None:
    box = device({"kind": "rectangular", "ratio": 1.25})
    plain = mould(box).body.cast.volume()
    assert plain == pytest.approx(20.0 * 16.0 * 100.0, rel=1e-9)
    larger = mould(box, MouldOptions(shrinkage=0.01)).body.cast.volume()
    assert larger == pytest.approx(plain / 0.99**3, rel=1e-9)
    wider = mould(box, MouldOptions(draft=radians(2.0))).body.cast.volume()
    assert wider == pytest.approx(plain + 100.0 * 16.0**2 * tan(radians(2.0)), rel=1e-9)


def test_pins_fit_with_their_clearance(finger: Device) -> None:
    loose, tight = (mould(finger, MouldOptions(clearance=gap)) for gap in (0.3e-3, 0.0))
    for made in (loose, tight):
        assert abs((made.lower ^ made.upper).volume()) < 1e-6
    assert loose.upper.volume() < tight.upper.volume()
    assert loose.lower.volume() < tight.lower.volume()  # bores for the pins of the end plates


UNDERCUT: dict[str, Any] = {
    "kind": "composite",
    "parts": [
        {"shape": "rectangle", "z": -0.75, "width": 3.0, "height": 0.5},
        {"shape": "rectangle", "z": 0.0, "width": 1.0, "height": 1.0},
        {"shape": "rectangle", "z": 0.75, "width": 2.0, "height": 0.5},
    ],
}


@pytest.mark.parametrize(
    ("section", "more", "options", "sentence"),
    [
        (
            {**TUBE, "wall": "0.6 mm"},
            {},
            {},
            r'the wall around the cavity "bore" is 0\.6 mm thick at X = 0, less than the 1 mm',
        ),
        ({**HALF, "floor": "8 mm", "wall": "7.3 mm"}, {}, {}, r'the core of the cavity "bore" is'),
        (UNDERCUT, {}, {}, r"rod\.section has an undercut of 8 mm at X = 0, y = -?\d"),
        (
            TUBE,
            {"rod": {"radius": ["6 mm", "14 mm", "6 mm"]}},
            {},
            r'the core of "air" has an undercut at X = 0\.5: to pull it out at the base, the '
            r"silicone would be stretched by \d+ %, more than the 50 % of --stretch",
        ),
        (TUBE, {"actuators": {"air": air(0.3, 0.6)}}, {}, "reaches neither end of the rod"),
        (TUBE, {}, {"wall": 1.5e-3}, "must be at least twice the 1 mm of --least-wall"),
        (TUBE, {}, {"pour": 15e-3}, "are too wide for a body of 16 mm by 100 mm"),
    ],
)
def test_what_cannot_be_cast_is_refused(
    section: Any, more: Any, options: dict[str, float], sentence: str
) -> None:
    made = device(section, **{"actuators": {"air": air()}, **more} if section != UNDERCUT else more)
    with pytest.raises(InputError, match=sentence):
        mould(made, MouldOptions(**options), BodyOptions(inlet=0.2e-3))


def test_a_core_that_bulges_is_pulled_with_some_stretch() -> None:
    made = device(TUBE, rod={"radius": ["8 mm", "9 mm", "8.5 mm"]}, actuators={"air": air()})
    (core,) = mould(made).cores
    # The bore of 6 mm at the base, 7 in the middle and 6.5 at the tip.
    assert core.pull == "tip"
    assert core.stretch == pytest.approx(7.0 / 6.5 - 1.0, rel=1e-3)
    assert core.place == pytest.approx(0.5, abs=0.02)


def test_layers_of_a_box_lie_on_the_parting_surface() -> None:
    box = {
        "kind": "box",
        "width": "24 mm",
        "wall": "2 mm",
        "floor": "2.5 mm",
        "layer": {"thickness": "0.5 mm", "material": "fabric"},
    }
    made = mould(device(box, actuators={"air": air()}))
    assert np.concatenate(made.body.heights) == pytest.approx(-8.0)
    assert made.lower.bounding_box()[5] > -8.0  # its pins
    assert (made.lower ^ made.body.cast).volume() == pytest.approx(0.0, abs=1e-6)


def test_a_strip_on_a_tube_is_bonded_to_what_is_cast() -> None:
    strip = {"thickness": "0.3 mm", "width": "4 mm", "material": "fabric"}
    plain = {"kind": "tube", "wall": "2 mm"}
    made = mould(device({**plain, "layer": strip}, actuators={"air": air()}))
    bare = mould(device(plain, actuators={"air": air()}))
    assert made.body.cast.volume() == pytest.approx(bare.body.cast.volume())
    (layer,) = sheets(made.body)
    assert layer.applied
    assert layer.size[1] == pytest.approx(4.0)
    text = " ".join(steps(made))
    assert "bond it with silicone along the middle of the underside" in text
    assert "lower half where it belongs" not in text
