"""Rods and links touch through their skins: closed forms, convergence, reports and bad input."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.model import Model, parse

EXAMPLE = Path(__file__).parents[2] / "examples" / "pneumatic-finger.toml"
PRESSED = """
name = "pressed"
planar = true

[bodies.limb]
kind = "link"
length = "15 cm"
radius = "1 cm"
placement = { x = "-5 cm" }
skin = { modulus = "100 kPa", thickness = "2 mm" }

[bodies.suit]
kind = "rod"
length = "5 cm"
radius = "8 mm"
young_modulus = "100 GPa"
poisson_ratio = 0.5
skin = [{ modulus = "1 MPa", thickness = "3 mm" }, { modulus = "500 kPa", thickness = "1 mm" }]
tip = "1.25 cm"
placement = { z = "1.8 cm" }
joint = { kind = "prismatic", axis = "z", stiffness = "20 N/m" }
strain = { bend_y = "nodal_linear" }
elements = 4
gauss_points = 2

[wrenches.push]
body = "suit"
at = 0.5
force = { z = "-1 N" }
input = true
"""
# 2 mm/100 kPa + 3 mm/1 MPa + 1 mm/500 kPa = 25 nm/Pa.
FOUNDATION = 1.0 / 25e-9


@pytest.mark.parametrize("planar", [True, False])
def test_a_pressed_rod_sinks_in_as_by_hand(planar: bool) -> None:
    text = PRESSED if planar else PRESSED.replace("planar = true", "planar = false")
    model = Model(parse(text))
    np.testing.assert_allclose(model.slot("suit.skin.foundation"), FOUNDATION)
    path = model.equilibrium([0.0, 0.5, 2.0])
    assert path.stable[1:].all()
    # f = 4/3 k √(2 R d) d over 5 cm with R = 1/(1/8 mm + 1/10 mm).
    across = 4.0 / 3.0 * FOUNDATION * np.sqrt(2.0 / 225.0) * 0.05
    depth = path.max_overlap[1:]
    pressed = np.array([0.5, 2.0]) - 20.0 * depth  # the slider's spring takes a little
    np.testing.assert_allclose(across * depth**1.5, pressed, rtol=1e-4)
    np.testing.assert_allclose(path.max_contact_pressure[1:], FOUNDATION * depth, rtol=1e-6)
    np.testing.assert_allclose(path.tip_force[1:], 0.25 * pressed, rtol=1e-4)
    assert path.touching.tolist()[1:] == [12, 12]
    assert path.sphere_count == 12
    found = path[-1].extremes()["max_contact_pressure"]
    assert (found.body, found.on) == ("suit", "limb")
    pressure = path[-1].contact_pressure()
    np.testing.assert_allclose(pressure["suit"][:, 0], model.file.rod("suit").sample_points)
    np.testing.assert_allclose(pressure["suit"][:, 1], FOUNDATION * depth[1], rtol=1e-4)
    # The rod lies over the middle third of the limb.
    np.testing.assert_allclose(pressure["limb"][[0, -1], 0], [1.0 / 3.0, 2.0 / 3.0], rtol=1e-4)


@pytest.mark.parametrize(
    ("section", "half_width", "roundness"),
    [
        ('{ kind = "elliptic", ratio = 2.0 }', 0.016, 0.25),
        ('{ kind = "rectangular", ratio = 1.5 }', 0.012, 0.0),
        ('{ kind = "tube", wall = "1 mm", material = "m" }', 0.008, 1.0),
        ('{ kind = "half-round", wall = "1 mm", floor = "2 mm", material = "m" }', 0.014, 0.0),
        ('{ kind = "box", wall = "1 mm", width = "2 cm", material = "m" }', 0.01, 0.0),
        (
            '{ kind = "composite", parts = [{ shape = "disc", radius = 1.0, material = "m" }] }',
            0.008,
            1.0,
        ),
    ],
)
def test_the_underside_is_that_of_the_section(
    section: str, half_width: float, roundness: float
) -> None:
    text = PRESSED.replace('radius = "8 mm"\n', f'radius = "8 mm"\nsection = {section}\n')
    if '"m"' in section:
        text = text.replace('young_modulus = "100 GPa"\npoisson_ratio = 0.5\n', "")
        text += '[materials.m]\nkind = "linear"\nyoung_modulus = "1 MPa"\n'
    model = Model(parse(text))
    constant, multiple = (model.slot(f"suit.skin.half_width{part}") for part in ("", "_multiple"))
    np.testing.assert_allclose(constant + 0.008 * multiple, half_width)
    assert model.foundations[0]["roundness"] == pytest.approx(roundness)


def test_a_rod_across_a_link_does_not_feel_that_it_is_round() -> None:
    text = PRESSED.replace("planar = true", "planar = false")
    assert Model(parse(text)).foundations[0]["alignment"] == pytest.approx(1.0)
    turned = text.replace('{ z = "1.8 cm" }', '{ z = "1.8 cm", rotation = { z = "60 deg" } }')
    assert Model(parse(turned)).foundations[0]["alignment"] == pytest.approx(0.25)


def test_skins_of_joined_links_meet_in_their_mean() -> None:
    more = """
[bodies.end]
kind = "link"
parent = "limb"
length = "2 cm"
radius = "1 cm"
skin = { material = "finger-subcutis", thickness = "2.04 mm" }
"""
    model = Model(parse(PRESSED + more))
    # M = 3 E = 102 kPa; the suit adds 5 nm/Pa.
    expected = 1e9 / np.array([25.0, 22.5 + 2.5, 22.5 + 2.5, 25.0])
    np.testing.assert_allclose(model.slot("suit.skin.foundation"), expected, rtol=1e-6)
    assert [cone["joined"] for cone in model.foundations[0]["cones"]] == [False, True]
    stiffer = more.replace("2.04 mm", "1.02 mm")
    found = Model(parse(PRESSED + stiffer)).slot("suit.skin.foundation")
    np.testing.assert_allclose(found, 1e9 / np.array([25.0, 20.0, 20.0, 15.0]), rtol=1e-6)


def test_designs_have_exact_gradients_and_the_same_bits_on_any_number_of_threads() -> None:
    model = flexor.load(EXAMPLE)
    space = flexor.design.parameter_set("L+R01", model.design)
    middle = 0.5 * (space.lower + space.upper)
    exact = model.evaluate(
        space.geometry(middle[None], model.X), gradient=True, tolerance=1e-12
    ).chained(space.jacobian(middle[None], model.X))[0]
    for i, width in enumerate(space.upper - space.lower):
        step = np.zeros(space.size)
        step[i] = 1e-5 * width
        designs = middle + np.array([-2.0, -1.0, 1.0, 2.0])[:, None] * step
        geometry = space.geometry(designs, model.X)
        both = [model.evaluate(geometry, threads=n, tolerance=1e-12) for n in (1, 2)]
        assert both[0].q.tobytes() == both[1].q.tobytes()
        last = np.column_stack([both[0].joint_angles[:, -1], both[0].tip_force[:, -1]])
        slope = np.array([1.0, -8.0, 8.0, -1.0]) @ last / (12.0 * step[i])
        np.testing.assert_allclose(exact[:, i], slope, rtol=1e-4, atol=1e-4 * abs(exact).max())


def test_results_say_where_device_and_wearer_are_loaded_most() -> None:
    path = flexor.load(EXAMPLE).equilibrium()
    found = json.loads(json.dumps(path.to_dict()))
    for key in ("max_overlap", "max_contact_pressure", "max_strain", "min_stretch"):
        np.testing.assert_array_equal(found[key], getattr(path, key))
    last = {key: places[-1] for key, places in found["places"].items()}
    assert last["max_contact_pressure"]["on"] == "ph_3"
    assert last["max_strain"]["body"] == "exosuit"
    assert found["places"]["max_contact_pressure"][0] is None
    assert found["warnings"] == []
    assert "hoop_strain" not in found
    state = path[-1]
    index = int(np.argmax(state.contact_pressure()["exosuit"][:, 1]))
    assert state.contact_pressure()["exosuit"][index, 0] == last["max_contact_pressure"]["X"]
    highest = max(rows[:, 1].max() for name, rows in state.contact_pressure().items())
    assert highest == path.max_contact_pressure[-1]


def test_skins_pressed_by_half_of_their_thickness_come_with_a_warning() -> None:
    path = flexor.load(EXAMPLE).equilibrium("0:100:20 kPa")
    deep = 0.5 * (2.0e-3 + 2.5e-3)  # skins of exosuit and finger
    assert path.max_overlap is not None
    (first,) = np.flatnonzero(np.diff(path.max_overlap > deep)) + 1
    (warning,) = (each for each in path.warnings if each.startswith("bodies overlap"))
    assert f"from {20 * first} kPa on by more than 2.25 mm" in warning
    assert f"by {1e3 * path.max_overlap.max():.3g} mm" in warning


def test_a_cavity_without_winding_comes_with_a_warning() -> None:
    model = flexor.load(EXAMPLE, changes={"materials.silicone.winding": "none"})
    path = model.equilibrium("0:4:1 kPa")
    # At the base: bore 11.5 mm, wall 2 mm, E = 1.5 Σ α μ.
    young = 1.5 * (3.0792 * 114.23e3 - 6.1849 * 472.83)
    expected = 1.5e3 * 13.5**2 / (13.5**2 - 11.5**2) / young * np.arange(5)
    np.testing.assert_allclose(path.hoop_strain()["chamber"], expected, rtol=1e-3)
    (warning,) = path.warnings
    assert warning.startswith('the cavity of "chamber" is not wound and widens by an estimated 4.')
    assert "from 1 kPa on" in warning
    assert path.to_dict()["warnings"] == [warning]


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            '{ modulus = "100 kPa", thickness = "2 mm" }',
            '{ modulus = "100 kPa" }',
            'bodies.limb.skin.thickness is missing: write a length with its unit, such as "10 cm".',
        ),
        (
            'modulus = "100 kPa"',
            'material = "finger-derms"',
            'bodies.limb.skin.material refers to the unknown material "finger-derms" (did you mean '
            '"finger-dermis"?)',
        ),
        (
            'modulus = "100 kPa", ',
            "",
            "bodies.limb.skin has both or neither of modulus and material: give one of them.",
        ),
        (
            'thickness = "2 mm"',
            'thickness = "0 mm"',
            'bodies.limb.skin.thickness is "0 mm": it must be greater than zero.',
        ),
        (
            'modulus = "100 kPa"',
            'modulus = "100 N/m"',
            'bodies.limb.skin.modulus is "100 N/m", which is not an elastic modulus',
        ),
        ('tip = "1.25 cm"', 'tip = "6 cm"', 'bodies.suit.tip is "6 cm": the rod is shorter.'),
        (
            'skin = [{ modulus = "1 MPa", thickness = "3 mm" }, { modulus = "500 kPa", thickness ='
            ' "1 mm" }]\n',
            "",
            "bodies.suit.tip is given without a skin, through which the rod touches.",
        ),
    ],
)
def test_one_sentence(old: str, new: str, sentence: str) -> None:
    assert old in PRESSED
    with pytest.raises(InputError) as caught:
        parse(PRESSED.replace(old, new), source="bad.toml")
    assert str(caught.value).startswith(f"bad.toml: {sentence}"), str(caught.value)


CURLED = """
name = "curled"
planar = true

[bodies.tail]
kind = "rod"
length = "30 cm"
radius = "5 mm"
young_modulus = "300 kPa"
poisson_ratio = 0.5
skin = { modulus = "300 kPa", thickness = "2 mm" }
strain = { bend_y = "nodal_linear" }
elements = 30
gauss_points = 2

[wrenches.curl]
body = "tail"
at = "tip"
moment = { y = "4.5 mN*m" }
frame = "world"
input = true
"""


def test_a_long_rod_touches_itself() -> None:
    """A moment that would bend the rod by more than a full turn presses its tip on its base."""
    curled = {}
    for text in ("", "self_contact = false\n"):
        model = Model(parse(CURLED.replace("gauss_points = 2\n", f"gauss_points = 2\n{text}")))
        curled[text] = model.equilibrium(np.linspace(0.0, 1.0, 21))
        assert curled[text].converged.all()
    free, held = curled["self_contact = false\n"], curled[""]
    # M L / EI: 4.5 mN m × 30 cm / (300 kPa π (5 mm)⁴/4) = 9.17 rad.
    turn = 4.5e-3 * 0.3 / (3e5 * np.pi * 0.005**4 / 4.0)
    np.testing.assert_allclose(free.q[-1], turn, rtol=1e-6)
    assert free.max_overlap.max() == 0.0
    assert held.max_overlap[10] == 0.0
    assert 0.0 < held.max_overlap[-1] < 1e-3
    short = CURLED.replace('"30 cm"', '"6 cm"')
    assert "contacts" not in json.loads(Model(parse(short))._description)
