"""Parts in space that cannot leave a plane are followed in it, with the results of space."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.design import variables
from flexor.model import Model, parse
from flexor.model.separate import Separate

GLOVE = """
name = "two"
{more}
[parts.index]
file = "glove-finger"
placement = {{ y = "-2 cm", rotation = {{ x = "70 deg", y = "20 deg", z = "-40 deg" }} }}
[parts.middle]
file = "glove-finger"
scale = 1.1
placement = {{ y = "2 cm" }}
[inputs]
air = ["index.chamber", "middle.chamber"]
[evaluation]
loads = {{ air = "0:60:20 kPa" }}
"""
VARIED: dict[str, tuple[object, object]] = {
    "*.exosuit.radius.base": ("5 mm", "8 mm"),
    "*.exosuit.section.wall": ("1.5 mm", "2.2 mm"),
    "index.ph_1.joint.stiffness": ("0.02 N*m/rad", "0.1 N*m/rad"),
}
ARRAYS = (
    "q",
    "energy",
    "applied",
    "volume",
    "rod_bending",
    "stretch",
    "tip_force",
    "max_overlap",
    "max_contact_pressure",
    "touching",
)


def glove(more: str = "", planes: bool = True) -> Model:
    """Return a glove of two fingers, in their planes or in space."""
    model = Model(parse(GLOVE.format(more=more)))
    assert isinstance(model.followed, Separate)
    for each in () if planes else model.followed.components:
        each.__dict__["plane"] = None
    return model


def planes(model: Model) -> list[bool]:
    """Return which components are followed in a plane."""
    assert isinstance(model.followed, Separate)
    return [each.plane is not None for each in model.followed.components]


def check_same(found: flexor.model.Paths, expected: flexor.model.Paths) -> None:
    """Check that results are the same but for rounding."""
    for name in ARRAYS:
        one, other = getattr(found, name), getattr(expected, name)
        np.testing.assert_allclose(one, other, rtol=1e-8, atol=1e-9 * np.nanmax(np.abs(other)))
    assert (found.status == expected.status).all()
    assert (found.stability == expected.stability).all()


@pytest.mark.parametrize("more", ["", "gravity = { z = '-9.81 m/s^2' }"])
def test_results_are_those_in_space(more: str) -> None:
    """With gravity in the plane of one of both."""
    model, space = glove(more), glove(more, planes=False)
    assert planes(model) == [not more, True]
    drawn = np.random.default_rng(3)
    chosen = variables(VARIED, model)
    designs = drawn.uniform(chosen.lower, chosen.upper, (4, chosen.size))
    slots, _ = chosen.designs(designs, model)
    found, expected = (each.evaluate(slots, gradient=True) for each in (model, space))
    assert found.converged.all() and (found.stability == "stable").all()
    check_same(found, expected)
    np.testing.assert_allclose(
        found.gradient, expected.gradient, rtol=1e-6, atol=1e-7 * np.abs(expected.gradient).max()
    )
    assert found[1].to_dict()["coordinates"] == expected[1].to_dict()["coordinates"]
    places = [each[1].frames(-1) for each in (found, expected)]
    for one, other in zip(*(each.values() for each in places), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-9)


def test_the_numbers_are_those_of_the_finger_alone() -> None:
    model = glove()
    alone = flexor.load("glove-finger").equilibrium(["0 kPa", "20 kPa", "40 kPa", "60 kPa"])
    found = model.equilibrium()
    mine = [name.startswith("index.") for name in model.engine.coordinates]
    np.testing.assert_allclose(found.q[:, mine], alone.q, rtol=1e-9, atol=1e-10)


def test_a_start_and_events_are_those_in_space() -> None:
    model, space = glove(), glove(planes=False)
    runs = []
    for each in (model, space):
        bent = each.equilibrium(["0 kPa", "30 kPa"])
        runs.append(each.equilibrium(["30 kPa", "10 kPa"], start=bent[-1]))
    np.testing.assert_allclose(runs[0].q, runs[1].q, rtol=1e-8, atol=1e-9)


@pytest.mark.parametrize(
    ("more", "which"),
    [
        ("gravity = { y = '-9.81 m/s^2' }", [False, False]),
        ("planar = false", [True, True]),
        (
            "[springs.line]\nfirst = { body = 'middle.ph_3', at = 'tip' }\n"
            "second = { world = { x = '10 cm' } }\nstiffness = '5 N/m'\nrest_length = '1 cm'",
            [True, False],
        ),
        (
            "[torques.stiff]\nkind = 'table'\nbody = 'index.ph_1'\n"
            "angles = ['0 deg', '90 deg']\ntorques = ['0 N*m', '0.1 N*m']",
            [True, True],
        ),
    ],
)
def test_what_has_to_be_followed_in_space(more: str, which: list[bool]) -> None:
    """Gravity across the plane and points in the world; torques of joints stay in the plane."""
    assert planes(glove(more)) == which


def test_freedoms_out_of_the_plane_stay_in_space() -> None:
    """A joint of the thumb that has two axes, and a rod that can bend to its side."""
    assert planes(flexor.load("glove")) == [True, True, True, True, False]
    for change in (
        {"index.ph_1.joint": {"kind": "universal", "stiffness": "0.04 N*m/rad"}},
        {"index.ph_2.joint.axis": [0.0, 0.8, 0.6]},
        {"index.ph_2.placement": {"y": "1 mm"}},
        {"index.exosuit.strain.bend_z": "nodal_linear"},
    ):
        assert planes(flexor.load(glove().file, changes=change)) == [False, True], change


def test_designs_that_leave_the_plane_are_followed_in_space() -> None:
    """A place of the rod beside the finger, and a turn of a phalanx out of its plane."""
    fields: dict[str, tuple[object, object]] = {
        "middle.exosuit.placement.y": ("19 mm", "21 mm"),
        "middle.ph_2.placement.rotation.x": ("-3 deg", "3 deg"),
    }
    model, space = glove(), glove(planes=False)
    for name, ends in fields.items():
        chosen = variables({name: ends}, model)
        slots, _ = chosen.designs(np.array([chosen.start, chosen.lower]), model)
        found, expected = model.evaluate(slots), space.evaluate(slots)
        check_same(found, expected)
        assert np.abs(found.q[1] - found.q[0]).max() > 1e-6


def test_the_offset_of_a_coupling_is_no_vector() -> None:
    """Two fingers whose inner muscles couple their joints."""
    parts = "".join(f"[parts.{key}]\nfile = 'finger-two-chambers'\n" for key in "ab")
    inputs = "close = ['a.knuckle', 'b.knuckle']\nmj = ['a.middle-joint', 'b.middle-joint']\n"
    model = Model(parse(f"name = 'two'\n{parts}[inputs]\n{inputs}"))
    assert planes(model) == [True, True]
    loads = {"knuckle": "0:10:10 kPa", "middle-joint": "0:40:40 kPa"}
    alone = flexor.load("finger-two-chambers").equilibrium(loads)
    found = model.equilibrium(dict(zip(("close", "mj"), loads.values(), strict=True)))
    for half in np.split(found.q, 2, axis=1):
        np.testing.assert_allclose(half, alone.q, rtol=1e-9, atol=1e-10)
