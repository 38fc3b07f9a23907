"""Rods with several sections, and materials that only the library has."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import tomli_w

from flexor import materials
from flexor.errors import InputError
from flexor.model import Model, parse

HALF: dict[str, Any] = {"kind": "half-round", "wall": "2 mm", "floor": "2 mm"}


def document(section: Any, **rod: Any) -> dict[str, Any]:
    return {
        "name": "pieces",
        "planar": True,
        "materials": {
            "silicone": {"library": "dragon-skin-30", "winding": "hoop"},
            "bone": {"kind": "linear", "young_modulus": "1 GPa"},
        },
        "bodies": {
            "rod": {
                "kind": "rod",
                "length": "12 cm",
                "radius": "8 mm",
                "material": "silicone",
                "section": section,
                "strain": {"bend_y": "nodal_linear", "extend_x": "nodal_linear"},
                "elements": 12,
                "gauss_points": 2,
                **rod,
            }
        },
        "actuators": {"air": {"kind": "pressure", "rod": "rod"}},
    }


def build(content: dict[str, Any]) -> Model:
    return Model(parse(tomli_w.dumps(content)))


def test_a_stiff_piece_stays_straight() -> None:
    """A bellows over a joint: the chamber bends its own length, and its volume is that part's."""
    stiff = {"kind": "rectangular", "ratio": 1.0}
    whole = build(document(HALF)).equilibrium([0.0, 20e3])
    pieces = [
        {
            "span": [0.0, 0.5],
            "kind": "composite",
            "parts": [
                {"shape": "rectangle", "width": 2.0, "height": 2.0, "material": "bone"},
            ],
        },
        {"span": [0.5, 1.0], **HALF},
    ]
    model = build(document(pieces))
    half = model.equilibrium([0.0, 20e3])
    assert half.stable.all()
    assert half.volume[0, 0] == pytest.approx(0.5 * whole.volume[0, 0], rel=1e-12)
    angles = [np.arctan2(*path.frames(1)["rod"][-1][[0, 0], [2, 0]]) for path in (whole, half)]
    assert angles[1] == pytest.approx(0.5 * angles[0], rel=0.05)
    straight = half.frames(1)["rod"][model.file.rod("rod").point_at(5 / 12)]
    assert abs(straight[0, 2]) < 0.01
    assert parse(tomli_w.dumps(model.file.to_document())) == model.file
    with pytest.raises(InputError, match=r"rod\.section\[1\]\.span is missing"):
        build(document([{"span": [0.0, 0.5], **stiff}, HALF]))


@pytest.mark.parametrize(
    ("section", "sentence"),
    [
        ({**HALF, "span": [0.0, 1.0]}, "section.span is given, but the rod has one section"),
        ([{**HALF, "span": [0.0, 0.5]}], "section[0].span ends at 0.5: the last section must"),
        (
            [{**HALF, "span": [0.0, 0.3]}, {**HALF, "span": [0.3, 1.0]}],
            "section[0].span ends at 0.3: it must be an element boundary, a multiple of 1/12",
        ),
        (
            [{**HALF, "span": [0.0, 0.5]}, {**HALF, "span": [0.75, 1.0]}],
            "section[1].span is [0.75, 1.0]: it must begin at 0.5 and end after that",
        ),
        (
            {
                "kind": "composite",
                "parts": [
                    {"shape": "rectangle", "y": 0.1, "width": 1.0, "height": 1.0},
                    {"shape": "disc", "y": -0.5, "radius": 0.1, "cavity": "bore"},
                    {"shape": "rectangle", "y": -0.9, "width": 0.1, "height": 1.0},
                ],
            },
            "section is not symmetric in y, as a section of a planar model has to be",
        ),
    ],
)
def test_one_sentence(section: Any, sentence: str) -> None:
    with pytest.raises(InputError) as raised:
        build(document(section))
    assert str(raised.value).startswith(f"model: bodies.rod.{sentence}")


def test_a_material_of_the_library_needs_no_table() -> None:
    content = document({**HALF, "material": "ecoflex-00-30"})
    file = parse(tomli_w.dumps(content))
    found = file.materials["ecoflex-00-30"].material("x")
    assert found.constants == materials.find("ecoflex-00-30").constants
    assert file.materials["silicone"].winding == "hoop"
    assert file.materials["silicone"].strain_limit == 2.0
    content["materials"]["silicone"]["alpha"] = [2.0, 4.0]
    assert parse(tomli_w.dumps(content)).materials["silicone"].alpha == (2.0, 4.0)


@pytest.mark.parametrize(
    ("table", "sentence"),
    [
        ({"library": "dragon"}, 'silicone.library refers to the unknown material "dragon"'),
        (
            {"library": "dragon-skin-30", "kind": "linear"},
            'silicone.kind is "linear", but "dragon-skin-30" of the library is ogden',
        ),
    ],
)
def test_what_the_library_does_not_have(table: dict[str, str], sentence: str) -> None:
    content = document(HALF)
    content["materials"]["silicone"] = table
    with pytest.raises(InputError) as raised:
        build(content)
    assert str(raised.value).startswith(f"model: materials.{sentence}")
