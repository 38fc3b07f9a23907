"""Variants and sets of constants: one applied, all validated."""

from __future__ import annotations

from pathlib import Path

import pytest

from flexor.errors import InputError
from flexor.model import Model, load, parse
from flexor.model.reading import check

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


def test_the_file_selects_the_active_set() -> None:
    assert modulus_and_lever(BASE) == (30_000.0, 1.0)
    assert modulus_and_lever(BASE.replace('use = "soft"', 'use = "stiff"')) == (2e6, 4.5)


def test_the_caller_can_override_the_active_set_and_it_is_written() -> None:
    assert modulus_and_lever(BASE, use="stiff") == (2e6, 4.5)
    written = parse(BASE, use="stiff").to_toml()
    assert modulus_and_lever(written) == (2e6, 4.5)
    assert parse(written, use="soft") == parse(BASE)


def test_unknown_set() -> None:
    expected = (
        'rod.toml: unknown set of constants "sotf" (did you mean "soft"?): '
        'expected one of "soft", "stiff".'
    )
    assert message(BASE, use="sotf") == expected
    assert message(BASE.replace('use = "soft"', 'use = "sotf"')) == expected


def test_a_file_with_sets_must_use_one() -> None:
    expected = 'rod.toml: use is missing: select a set of constants, "soft" or "stiff".'
    assert message(BASE.replace('use = "soft"', "")) == expected


def test_selecting_a_set_in_a_file_without_sets() -> None:
    text = BASE[: BASE.index("[constants.soft]")].replace('use = "soft"', "")
    assert message(text, use="soft") == ('rod.toml: unknown variant "soft": none are defined.')


def test_all_sets_must_define_the_same_fields() -> None:
    assert message(BASE.replace("actuators.chamber.lever = 4.5\n", "")) == (
        "rod.toml: constants.stiff.actuators.chamber.lever is missing: all sets of constants must "
        "define the same fields, and constants.soft defines it."
    )


@pytest.mark.parametrize("use", ["soft", "stiff"])
def test_inactive_sets_are_validated_too(use: str) -> None:
    assert message(BASE.replace('"2 MPa"', '"2 kg"'), use=use) == (
        'rod.toml: constants.stiff.bodies.suit.young_modulus is "2 kg", which is not an elastic '
        'modulus: write an elastic modulus with its unit, such as "30 kPa".'
    )


def test_sets_may_only_refer_to_existing_tables() -> None:
    assert message(BASE.replace("bodies.suit.young", "bodies.siut.young")) == (
        'rod.toml: constants.soft.bodies has an unknown key "siut" (did you mean "suit"?): '
        'expected "suit".'
    )
    assert message(BASE.replace("bodies.suit.young", "bodys.suit.young")) == (
        'rod.toml: constants.soft has an unknown table "bodys" (did you mean "bodies"?): '
        'expected one of "bodies", "actuators".'
    )


def test_a_set_must_be_a_table() -> None:
    text = BASE[: BASE.index("[constants.soft]")] + '[constants]\nsoft = "30 kPa"\n'
    assert message(text) == 'rod.toml: constants.soft is "30 kPa": expected a table of fields.'


def test_changing_a_field_changes_it_in_all_sets() -> None:
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
            'unknown field "siut" (did you mean "suit"?): expected one of "suit", "chamber", '
            '"name", '
            '"title", "planar", "gravity", "bodies", "materials", "spheres", "contacts", '
            '"obstacles", "actuators", '
            '"torques", "couplings", "springs", "straps", "tendons", "wraps", "wrenches", '
            '"ties", "inputs", "design", '
            '"population", '
            '"evaluation", "start", "solver", "constants", "variants", "use", "parts".',
        ),
        (
            "bodies.siut.length",
            "8 cm",
            'bodies has an unknown entry "siut" (did you mean "suit"?): expected "suit".',
        ),
        ("suit", "8 cm", "bodies.suit is a table: change its fields individually."),
        ("use", "stiff", "use cannot be changed: select a variant by name."),
        ("suit.length", "0 cm", 'bodies.suit.length is "0 cm": it must be greater than zero.'),
        (
            "suit.lenght",
            "8 cm",
            'bodies.suit has an unknown key "lenght" (did you mean "length"?): expected one of '
            '"kind", "parent", "placement", "joint", "length", "radius", "section", "material", '
            '"skin", "friction", "tip", "self_contact", "young_modulus", "poisson_ratio", '
            '"density", "strain", "reference_strain", "elements", "tip_intervals", '
            '"gauss_points", "magnus_order".',
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


VARIANTS = """
[variants.long]
weight = 0.25
bodies.suit.length = "30 cm"

[variants.strong]
actuators.chamber.lever = 9.0
"""


def test_variants_change_the_file_as_it_stands() -> None:
    file = parse(BASE + VARIANTS)
    assert set(file.variants) == {"long", "strong"} and file.rod("suit").length == 0.1
    assert parse(file.to_toml()) == file
    assert Model(file).variants == {"long": 0.25, "strong": 1.0}
    long = parse(BASE + VARIANTS, use="long")
    assert long.rod("suit").length == 0.3 and long.rod("suit").young_modulus == 30_000.0
    # A variant overrides the set of constants that is in use.
    strong = parse(BASE + VARIANTS, use="strong")
    assert strong.actuators["chamber"].lever.z == 9.0
    assert strong.constants == {} and parse(strong.to_toml()) == strong
    changed = parse(BASE + VARIANTS, use="long", changes={"suit.length": "20 cm"})
    assert changed.rod("suit").length == 0.2


ALTERNATIVES = (
    BASE.split("[constants.soft]")[0].replace('use = "soft"', "")
    + """
[variants.long]
bodies.suit.length = "30 cm"
bodies.suit.young_modulus = "30 kPa"

[variants.thin]
bodies.suit.radius = { base = "8 mm", tip = "6 mm" }
bodies.suit.young_modulus = "20 kPa"

[variants.slender]
weight = 2
bodies.suit.radius = "5 mm"
bodies.suit.young_modulus = "30 kPa"

[variants.dense]
bodies.suit.density = "1100 kg/m^3"
bodies.suit.young_modulus = "30 kPa"
"""
)


@pytest.mark.parametrize("first", ["long", "thin", "slender"])
def test_variants_are_alternatives_also_where_one_is_applied(first: str) -> None:
    """Each gives the same model, whichever has been applied before."""
    written = parse(ALTERNATIVES, use=first).to_toml()
    for name in ("long", "thin", "slender"):
        assert Model(parse(written, use=name)).hash == Model(parse(ALTERNATIVES, use=name)).hash
    assert parse(written) == parse(ALTERNATIVES, use=first)
    assert Model(parse(written)).variants["slender"] == 2.0


def test_what_a_variant_adds_cannot_be_taken_away() -> None:
    """Another variant would silently keep it, and is not offered."""
    dense = parse(ALTERNATIVES, use="dense")
    assert list(dense.variants) == ["dense"] and dense.use == "dense"


def test_a_section_of_another_kind_takes_the_place_of_the_first() -> None:
    document = load("pneumatic-finger").file.to_document()
    tube = {"kind": "tube", "wall": "2 mm"}
    document["variants"] = {
        "tube": {"bodies": {"exosuit": {"section": tube}}},
        "thin": {"bodies": {"exosuit": {"section": {"wall": "1.5 mm"}}}},
    }
    changed = check(document, use="tube")
    assert changed.rod("exosuit").section.kind == "tube"
    thin = check(changed.to_document(), use="thin").rod("exosuit").section
    assert (thin.kind, thin.wall, thin.floor) == ("half-round", 0.0015, 0.0025)


def test_the_preset_s_sets_are_variants() -> None:
    assert set(load("finger").variants) == {
        "surface",
        "printed",
        "calibrated",
        "calibrated-optimum",
    }
    assert load("finger", constants="printed").hash == load("finger", "printed").hash
    with pytest.raises(InputError, match="two names of the same"):
        load("finger", "printed", constants="printed")
    with pytest.raises(InputError, match=r'unknown variant "prined" \(did you mean "printed"\?\)'):
        load("finger", "prined")


@pytest.mark.parametrize(
    ("table", "sentence"),
    [
        ("long]\nweight = 0", "variants.long.weight is 0: it must be a number above 0."),
        ("soft]\nweight = 1", "variants.soft has the name of a set of constants."),
        ("long]\nbodies.suit.length = 3", "variants.long.bodies.suit.length is 3, a number with"),
        ("long]\nbody.suit.length = 3", 'variants.long has an unknown table "body"'),
    ],
)
def test_a_bad_variant_is_named(table: str, sentence: str) -> None:
    assert message(f"{BASE}\n[variants.{table}\n").startswith(f"rod.toml: {sentence}")


def test_a_variant_that_breaks_the_model_is_named(tmp_path: Path) -> None:
    """Also where what it breaks is not the field that it changes."""
    text = load("pneumatic-finger").file.to_toml()
    file = tmp_path / "torn.toml"
    torn = '\n[variants.torn.bodies.exosuit.section]\nwall = "40 mm"\n'
    file.write_text(text + torn)
    with pytest.raises(InputError, match=r"torn.toml: variants.torn: bodies.exosuit.section cann"):
        load(file)
    # What is wrong without it is no fault of the variant.
    file.write_text(text.replace('wall = "2 mm"', 'wall = "40 mm"') + torn.replace("40", "1"))
    with pytest.raises(InputError, match=r"torn.toml: bodies.exosuit.section cannot be made"):
        load(file)
    with pytest.raises(InputError, match=r"finger.toml: design.minimum_radius is .*3 cm"):
        load("finger", changes={"design.minimum_radius": "3 cm"})
