"""Sets of constants: one in force, all checked, all giving the same fields."""

from __future__ import annotations

import pytest

from flexor.errors import InputError
from flexor.model import parse

BASE = """
name = "rod"
use = "soft"

[bodies.suit]
kind = "rod"
length = "10 cm"
radius = "1 cm"
poisson_ratio = 0.5
strain = { bend_y = "nodal_linear" }
gauss_points = 2

[actuators.chamber]
kind = "chamber"
rod = "suit"
lever = 2.0

[constants.soft]
bodies.suit.young_modulus = "30 kPa"
actuators.chamber.lever = 1.0

[constants.stiff]
bodies.suit.young_modulus = "2 MPa"
actuators.chamber.lever = 4.5
"""


def message(text: str, use: str | None = None) -> str:
    with pytest.raises(InputError) as caught:
        parse(text, use=use, source="rod.toml")
    return str(caught.value)


def modulus_and_lever(text: str, use: str | None = None) -> tuple[float, float]:
    file = parse(text, use=use)
    return file.rod("suit").young_modulus, file.actuators["chamber"].lever.z


def test_the_file_says_which_set_is_in_force() -> None:
    assert modulus_and_lever(BASE) == (30_000.0, 1.0)
    assert modulus_and_lever(BASE.replace('use = "soft"', 'use = "stiff"')) == (2e6, 4.5)


def test_the_caller_may_say_otherwise_and_it_sticks() -> None:
    assert modulus_and_lever(BASE, use="stiff") == (2e6, 4.5)
    written = parse(BASE, use="stiff").to_toml()
    assert modulus_and_lever(written) == (2e6, 4.5)
    assert parse(written, use="soft") == parse(BASE)


def test_unknown_set() -> None:
    expected = (
        'rod.toml: unknown set of constants "sotf" (did you mean "soft"?): '
        'allowed are "soft", "stiff".'
    )
    assert message(BASE, use="sotf") == expected
    assert message(BASE.replace('use = "soft"', 'use = "sotf"')) == expected


def test_a_file_with_sets_must_use_one() -> None:
    expected = 'rod.toml: use is missing: say which constants are in force, "soft" or "stiff".'
    assert message(BASE.replace('use = "soft"', "")) == expected


def test_a_set_asked_of_a_file_without_sets() -> None:
    text = BASE[: BASE.index("[constants.soft]")].replace('use = "soft"', "")
    assert message(text, use="soft") == (
        'rod.toml: unknown set of constants "soft": there are none.'
    )


def test_all_sets_give_the_same_fields() -> None:
    assert message(BASE.replace("actuators.chamber.lever = 4.5\n", "")) == (
        "rod.toml: constants.stiff.actuators.chamber.lever is missing: all sets of constants give "
        "the same fields, and constants.soft gives this one."
    )


@pytest.mark.parametrize("use", ["soft", "stiff"])
def test_every_set_is_checked_and_named(use: str) -> None:
    assert message(BASE.replace('"2 MPa"', '"2 kg"'), use=use) == (
        'rod.toml: constants.stiff.bodies.suit.young_modulus is "2 kg", which is not an elastic '
        'modulus: write an elastic modulus with its unit, such as "30 kPa".'
    )


def test_sets_give_fields_only_to_what_is_there() -> None:
    assert message(BASE.replace("bodies.suit.young", "bodies.siut.young")) == (
        'rod.toml: constants.soft.bodies has the unknown key "siut" (did you mean "suit"?): '
        'allowed is "suit".'
    )
    assert message(BASE.replace("bodies.suit.young", "bodys.suit.young")) == (
        'rod.toml: constants.soft has the unknown table "bodys" (did you mean "bodies"?): '
        'allowed are "bodies", "actuators".'
    )


def test_a_set_must_be_a_table() -> None:
    text = BASE[: BASE.index("[constants.soft]")] + '[constants]\nsoft = "30 kPa"\n'
    assert message(text) == 'rod.toml: constants.soft is "30 kPa": a table of fields is needed.'


def test_changing_a_field_of_the_sets_changes_it_in_all_of_them() -> None:
    changes = {"suit.young_modulus": "1 MPa", "bodies.suit.length": "8 cm"}
    file = parse(BASE, changes=changes)
    assert file.rod("suit").young_modulus == 1e6
    assert file.rod("suit").length == 0.08
    assert parse(file.to_toml()) == file
    assert parse(file.to_toml(), use="stiff").rod("suit").young_modulus == 1e6


@pytest.mark.parametrize(
    ("path", "value", "sentence"),
    [
        (
            "siut.length",
            "8 cm",
            'unknown field "siut" (did you mean "suit"?): allowed are "suit", "chamber", "name", '
            '"title", "planar", "gravity", "bodies", "spheres", "contacts", "obstacles", '
            '"actuators", '
            '"springs", "wrenches", "design", "evaluation", "constants", "use".',
        ),
        (
            "bodies.siut.length",
            "8 cm",
            'bodies has the unknown entry "siut" (did you mean "suit"?): allowed is "suit".',
        ),
        ("suit", "8 cm", "bodies.suit is a table: change its fields one by one."),
        ("use", "stiff", "use cannot be changed: choose a set of constants by name."),
        ("suit.length", "0 cm", 'bodies.suit.length is "0 cm": it must be greater than zero.'),
        (
            "suit.lenght",
            "8 cm",
            'bodies.suit has the unknown key "lenght" (did you mean "length"?): allowed are '
            '"kind", "parent", "placement", "joint", "length", "radius", "section", '
            '"young_modulus", "poisson_ratio", "density", "strain", "reference_strain", '
            '"elements", "gauss_points", "magnus_order".',
        ),
        (
            "suit.length",
            "8",
            "bodies.suit.length is 8, a number without a unit: write a length with its unit, such "
            'as "10 cm".',
        ),
    ],
)
def test_bad_changes(path: str, value: str, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        parse(BASE, changes={path: value}, source="rod.toml")
    assert str(caught.value) == f"rod.toml: {sentence}"
