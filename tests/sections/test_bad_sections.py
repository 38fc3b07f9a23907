"""What cannot be made is refused in one sentence that names the field."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
import tomli_w

from flexor.errors import InputError
from flexor.model import Model, parse

SILICONE = {"kind": "neo-hookean", "shear_modulus": "0.3 MPa", "winding": "hoop"}
TUBE: dict[str, Any] = {"kind": "tube", "wall": "2 mm"}


def document(section: Mapping[str, Any], **rod: Any) -> dict[str, Any]:
    return {
        "name": "device",
        "planar": True,
        "materials": {"silicone": dict(SILICONE)},
        "bodies": {
            "rod": {
                "kind": "rod",
                "length": "10 cm",
                "radius": {"base": "8 mm", "tip": "5 mm"},
                "material": "silicone",
                "section": section,
                "strain": {"bend_y": "nodal_linear", "extend_x": "nodal_linear"},
                "elements": 4,
                "gauss_points": 2,
                **rod,
            }
        },
        "actuators": {"air": {"kind": "pressure", "rod": "rod"}},
    }


def build(content: Mapping[str, Any]) -> Model:
    return Model(parse(tomli_w.dumps(content)))


HALF: dict[str, Any] = {"kind": "half-round", "wall": "2 mm", "floor": "2 mm"}
RING: dict[str, Any] = {"shape": "ring", "radius": "6 mm", "wall": "2 mm"}
SQUARE: dict[str, Any] = {"shape": "rectangle", "width": "6 mm", "height": "6 mm"}


def parts(*every: Mapping[str, Any]) -> dict[str, Any]:
    return {"kind": "composite", "parts": list(every)}


@pytest.mark.parametrize(
    ("section", "sentence"),
    [
        (
            {**HALF, "flat_floor": False},
            "bodies.rod.section.flat_floor is false, but a floor that is free to bulge changes the "
            "shape of the section and is not modelled",
        ),
        (
            {**TUBE, "wall": "6 mm"},
            "bodies.rod.section cannot be made: wall leaves no bore: it must be less than the "
            "radius S, but S is 5.908 mm at X = 0.697",
        ),
        (
            {**TUBE, "layer": {"width": 2.5, "thickness": "0.1 mm", "material": "silicone"}},
            "bodies.rod.section cannot be made: layer.width must be less than the diameter 2 S, "
            "but S is 8 mm at X = 0",
        ),
        (
            {**TUBE, "layer": {"thickness": "0.1 mm", "material": "silicone"}},
            "bodies.rod.section.layer.width is missing",
        ),
        (
            {**HALF, "wall": 1.9},
            "bodies.rod.section cannot be made: wall leaves no bore: with the floor it must be "
            "less than the height 2 S, but S is 8 mm at X = 0",
        ),
        (
            {**HALF, "layer": {"thickness": "3 mm", "material": "silicone"}},
            "bodies.rod.section cannot be made: layer.thickness must be less than the floor, but S "
            "is 8 mm at X = 0",
        ),
        (
            {**HALF, "layer": {"thickness": "1 mm"}},
            "bodies.rod.section.layer.material is missing",
        ),
        (
            {**HALF, "layer": {"thickness": "1 mm", "material": "fabric"}},
            'bodies.rod.section.layer.material refers to the unknown material "fabric": '
            'expected one of "dragon-skin-10", ',
        ),
        (
            {"kind": "box", "width": "3 mm", "wall": "2 mm"},
            "bodies.rod.section cannot be made: wall leaves no bore: twice the wall must be less "
            "than the width, but S is 8 mm at X = 0",
        ),
        (
            parts(SQUARE, {**SQUARE, "z": "5 mm"}, {"shape": "disc", "radius": 0.1, "cavity": "c"}),
            "bodies.rod.section cannot be made: parts[0] and parts[1] overlap, where S is 8 mm",
        ),
        (
            parts(SQUARE, {"shape": "disc", "z": "9 mm", "radius": "2 mm", "cavity": "bore"}),
            "bodies.rod.section cannot be made: parts[1] is a cavity outside the section, where S "
            "is 8 mm",
        ),
        (
            parts({"shape": "ring", "radius": 1.0}),
            "bodies.rod.section.parts[0].wall is missing: a ring needs it",
        ),
        (
            "circular",
            'actuators.air.rod is "rod", whose section has no cavity: give it one, such as a tube',
        ),
        (
            {"kind": "pipe"},
            'bodies.rod.section has an unknown kind "pipe": expected one of "circular", '
            '"elliptic", "rectangular", "tube", "half-round", "box", "composite", "stiffness"',
        ),
        ({"kind": "stiffness"}, "bodies.rod.section.EA has no stiffness"),
        (
            {"kind": "stiffness", "EA": "10 N", "ES_y": "1 N*m", "EI_yy": "1e-3 N*m^2"},
            "bodies.rod.section.EA is not positive definite",
        ),
        ({"kind": "stiffness", "EA": "10 kPa"}, "bodies.rod.section.EA is "),
    ],
)
def test_one_sentence(section: Any, sentence: str) -> None:
    with pytest.raises(InputError) as raised:
        build(document(section))
    assert str(raised.value).startswith(f"model: {sentence}")
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("path", "value", "sentence"),
    [
        ("bodies.rod.young_modulus", "1 MPa", "bodies.rod.young_modulus is given, but the section"),
        ("bodies.rod.density", "1 g/cm^3", "bodies.rod.density is given, but the mass is that"),
        ("bodies.rod.material", "rubber", 'bodies.rod.material refers to the unknown material "ru'),
        ("materials.silicone.c1", "1 MPa", "materials.silicone.c1 is not a constant of a neo-hook"),
        ("materials.silicone.mu", "1 MPa", "materials.silicone.mu is not a constant of a neo-hook"),
        ("materials.silicone.kind", "yeoh", "materials.silicone.shear_modulus is not a constant"),
        (
            "materials.silicone.shear_modulus",
            "3 N",
            'materials.silicone.shear_modulus is "3 N", wh',
        ),
        ("actuators.air.cavity", "bor", 'actuators.air.cavity refers to the unknown cavity "bor"'),
        ("actuators.air.span", [0.5, 0.5], "actuators.air.span is [0.5, 0.5]: it must end after"),
        ("actuators.air.span", [0.0, 0.5, 1.0], "actuators.air.span has too many entries"),
    ],
)
def test_other_tables(path: str, value: Any, sentence: str) -> None:
    content = document(TUBE)
    table: Any = content
    *above, key = path.split(".")
    for part in above:
        table = table[part]
    table[key] = value
    with pytest.raises(InputError) as raised:
        build(content)
    assert str(raised.value).startswith(f"model: {sentence}")


@pytest.mark.parametrize(
    ("table", "sentence"),
    [
        (
            {"kind": "yeoh", "c1": "-1 kPa"},
            "materials.silicone cannot be used: the yeoh material has a Young's modulus of -6000 "
            "Pa at rest: expected a positive number",
        ),
        (
            {"kind": "ogden", "mu": ["1 kPa", "2 kPa"], "alpha": [2.0]},
            "mu and alpha of the material differ in length",
        ),
        (
            {"library": "ecoflex-00-30", "young_modulus": "1 MPa"},
            "materials.silicone.young_modulus is not a constant of a yeoh material: it has c1, c2, "
            "c3",
        ),
        (
            {"kind": "linear", "young_modulus": "1 MPa", "poisson_ratio": -1.0},
            "materials.silicone.poisson_ratio is -1.0: it must be greater than -1.0",
        ),
    ],
)
def test_materials(table: dict[str, Any], sentence: str) -> None:
    content = document(TUBE)
    content["materials"]["silicone"] = table
    with pytest.raises(InputError) as caught:
        build(content)
    assert sentence in str(caught.value)


@pytest.mark.parametrize(
    ("tip", "place"), [("2 mm", "2 mm at X = 1"), ("1 mm", "1.37 mm at X = 0.947")]
)
def test_walls_leave_a_bore_at_every_sample_point(tip: str, place: str) -> None:
    with pytest.raises(InputError, match=f"less than the radius S, but S is {place}"):
        build(document(TUBE, radius={"base": "8 mm", "tip": tip}))


def test_walls_leave_a_bore_where_a_section_begins() -> None:
    """A wall of 6.6 mm fits the Gauss points of a taper that widens from there."""
    pieces = [
        {**TUBE, "span": [0.0, 0.5]},
        {**TUBE, "wall": "6.6 mm", "span": [0.5, 1.0]},
    ]
    with pytest.raises(InputError, match=r"section\[1\] cannot be made.* 6.5 mm at X = 0.5\.$"):
        build(document(pieces, radius={"base": "5 mm", "tip": "8 mm"}))


def test_an_indefinite_matrix_is_named() -> None:
    matrix = np.diag([1.0, -1.0, 1.0, 1.0, 1.0, 1.0]).tolist()
    content = document({"kind": "stiffness", "matrix": matrix})
    del content["actuators"], content["bodies"]["rod"]["material"]
    with pytest.raises(InputError, match=r"section\.matrix is not positive definite"):
        build(content)


@pytest.mark.parametrize(
    ("winding", "tail"),
    [
        (
            "none",
            "is not wound, in a composite section, which is taken to keep its shape: how much it "
            "widens is not estimated",
        ),
        (
            "hoop",
            "is in a composite section, whose wound walls keep hoop stretch 1 and do not thin: "
            "tube, half-round and box model that",
        ),
    ],
)
def test_pressure_in_a_composite_has_a_warning(winding: str, tail: str) -> None:
    content = document(parts(RING, {"shape": "disc", "radius": "4 mm", "cavity": "bore"}))
    content["materials"]["silicone"]["winding"] = winding
    content["bodies"]["rod"]["radius"] = "6 mm"
    assert build(content).equilibrium([0.0, 1e3]).warnings == [f'the cavity of "air" {tail}']
    assert build(content).equilibrium([0.0]).warnings == []


def test_newtons_are_not_a_pressure() -> None:
    model = build(document(TUBE))
    with pytest.raises(InputError, match=r'^force is "5 N", which is not a pressure: write'):
        model.equilibrium("5 N")


def test_strain_beyond_a_limit_stays_with_the_result() -> None:
    content = document(TUBE)
    content["materials"]["silicone"] |= {"strain_limit": 0.1, "stress_limit": "20 kPa"}
    path = build(content).equilibrium("0:60:20 kPa")
    assert path.stable.all()
    strained, stressed = path.warnings
    assert strained.startswith('material "silicone" is strained by 0.')
    first = int(np.flatnonzero(path.max_strain > 0.1)[0])
    assert strained.endswith(f"from {20 * first} kPa on beyond its limit of 0.1")
    assert stressed.startswith('material "silicone" sees a stress of ')
    assert path.to_dict()["warnings"] == path.warnings
    assert build(document(TUBE)).equilibrium("0:60:20 kPa").warnings == []


def test_designs_that_cannot_be_made_are_invalid() -> None:
    from flexor.model import Geometry

    content = document({**TUBE, "wall": "2 mm"})
    content["design"] = {
        "rod": "rod",
        "minimum_radius": "1 mm",
        "length_bounds": ["6 cm", "14 cm"],
        "radius_bounds": ["1 mm", "9 mm"],
    }
    model = build(content)
    radius = np.array([[4e-3], [1.9e-3]]) * np.ones(model.X.size)
    geometry = Geometry(np.array([0.1, 0.1]), radius, np.zeros_like(radius))
    paths = model.evaluate(geometry, "0:5:5 kPa")
    assert paths.converged[0].all()
    assert set(paths.status[1]) == {"invalid-design"}
