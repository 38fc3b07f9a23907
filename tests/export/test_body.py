"""Solids of bodies: against closed forms and the sections of the mechanics."""

from __future__ import annotations

from math import pi
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import trimesh

import flexor
from flexor.errors import InputError
from flexor.export import BodyOptions, body, device_of, sheets, write_dxf, write_solid
from flexor.export.outlines import area, segments
from flexor.model.schema.section_geometry import section_at
from flexor.sections.shapes import moments
from tests.export.rods import HALF, TUBE, air, device


def test_a_capped_tube_has_the_volume_of_the_closed_form() -> None:
    made = body(device(TUBE, actuators={"air": air()}), BodyOptions(cap=4e-3, inlet=2e-3))
    wall = pi * (8.0**2 - 6.0**2) * 100.0
    caps = 2 * pi * 8.0**2 * 4.0 - pi * 1.0**2 * 4.0
    assert made.solid.volume() == pytest.approx(wall + caps, rel=2e-3)
    assert made.solid.bounding_box() == pytest.approx((-4, -8, -8, 104, 8, 8), abs=1e-9)
    assert [each.end for each in made.inlets] == ["base"]


def test_a_hollow_without_pressure_is_open() -> None:
    made = body(device(TUBE))
    assert not made.caps
    assert made.solid.genus() == 1
    assert made.solid.volume() == pytest.approx(pi * 28.0 * 100.0, rel=2e-3)


def test_chambers_end_in_walls_and_what_no_pressure_reaches_stays_hollow() -> None:
    two = {"near": air(0.0, 0.4), "far": air(0.4, 0.8)}
    made = body(device(TUBE, actuators=two))
    ends = [(each.pressure, each.low, each.high) for each in made.chambers]
    assert ends == [
        ("near", 0.0, pytest.approx(37.5)),
        ("far", pytest.approx(42.5), 80.0),
        (None, 85.0, 100.0),
    ]
    assert list(made.caps) == ["base"]
    assert [each.end for each in made.inlets] == ["base", "top"]
    # Cut across: where the walls are, and where it is hollow.
    turned = made.solid.rotate((0.0, -90.0, 0.0))
    for x, hollow in ((20.0, True), (40.0, False), (60.0, True), (82.0, False), (90.0, True)):
        expected = pi * (8.0**2 - 6.0**2 * hollow)
        assert turned.slice(x).area() == pytest.approx(expected, rel=5e-3)


SECTIONS: dict[str, Any] = {
    "elliptic": {"kind": "elliptic", "ratio": 1.7},
    "tube": TUBE,
    "half-round": {**HALF, "wall": ["1.5 mm", "3 mm", "2 mm"]},
    "box": {"kind": "box", "width": "20 mm", "wall": "1.5 mm", "floor": 0.3},
    "composite": {
        "kind": "composite",
        "parts": [
            {"shape": "half-ring", "radius": 1.5, "wall": 0.3, "z": -0.5},
            {"shape": "half-disc", "radius": 1.2, "z": -0.5, "cavity": "air"},
            {"shape": "rectangle", "z": -0.75, "width": 3.0, "height": 0.5},
        ],
    },
}


@pytest.mark.parametrize("kind", SECTIONS)
def test_outlines_have_the_moments_of_the_mechanics(kind: str) -> None:
    made = device(SECTIONS[kind], rod={"radius": ["8 mm", "10 mm", "7 mm"]})
    (part,) = segments(made)
    for row in range(0, len(part.x), 13):
        x = part.x[row] / 100.0
        geometry = section_at(made.rod, made.file.materials, 0, x)
        assert geometry is not None
        s = made.surface(x)
        coefficients = sum(moments((each.shape,)) for each in geometry.parts if not each.stiffening)
        expected = coefficients[:3] @ (1.0, s, s * s), coefficients[7:] @ (1.0, s, s**2, s**3)
        contours = [part.outer[row], *(points[row][::-1] for points in part.cavities.values())]
        assert sum(map(area, contours)) == pytest.approx(1e6 * expected[0], rel=1e-3)
        first = sum(_first_moment(contour) for contour in contours)
        assert first == pytest.approx(1e9 * expected[1], rel=5e-3, abs=1.0)


def _first_moment(polygon: np.ndarray) -> float:
    """∫ z dA by Green's theorem."""
    after = np.roll(polygon, -1, axis=0)
    cross = polygon[:, 0] * after[:, 1] - after[:, 0] * polygon[:, 1]
    return float((cross * (polygon[:, 1] + after[:, 1])).sum() / 6.0)


@pytest.mark.parametrize("name", ["body.stl", "body.3mf"])
def test_files_are_watertight_and_in_millimetres(tmp_path: Path, name: str) -> None:
    made = body(device_of(flexor.load("pneumatic-finger")))
    write_solid(made.solid, tmp_path / name)
    mesh = trimesh.load_mesh(tmp_path / name)
    if isinstance(mesh, trimesh.Scene):
        assert mesh.units == "millimeter"
        mesh = mesh.to_mesh()
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume == pytest.approx(made.solid.volume(), rel=1e-5)
    assert mesh.extents[0] == pytest.approx(110.0, abs=1e-3)


def test_layer_and_straps_are_cut_flat(tmp_path: Path) -> None:
    made = body(device_of(flexor.load("pneumatic-finger")))
    pieces = {each.name: each for each in sheets(made)}
    write_dxf(list(pieces.values()), tmp_path / "cut.dxf")
    document = ezdxf.readfile(tmp_path / "cut.dxf")
    assert document.header["$INSUNITS"] == 4
    drawn: dict[str, list[np.ndarray]] = {}
    for line in document.modelspace().query("LWPOLYLINE"):
        assert line.closed
        drawn.setdefault(line.dxf.layer, []).append(np.array(line.get_points("xy")))
    assert set(drawn) == {"layer-1", "strap-proximal", "strap-middle", "strap-distal"}
    assert len(drawn["layer-1"]) == 7  # its outline and six slots
    # Its length follows the sloping underside; it is as wide as the floor, with six ears.
    length = np.hypot(100.0, 2.0)
    ears = sum((ear.x[1] - ear.x[0]) * 2 * ear.y[1] for ear in made.ears)
    under = sum((ear.x[1] - ear.x[0]) * (27.0 - 0.08 * sum(ear.x) / 2) for ear in made.ears)
    slots = 6 * 16.0 * 2.0
    expected = 0.5 * (27.0 + 19.0) * length + (ears - under - slots) * length / 100.0
    assert sum(map(area, drawn["layer-1"])) == pytest.approx(expected, rel=1e-3)
    assert pieces["strap-middle"].size[1] == pytest.approx(15.0)


def test_a_strap_reaches_around_the_link() -> None:
    from flexor.export.sheets import around

    made = body(device_of(flexor.load("pneumatic-finger")))
    # Between the circumference of the finger there and that of the hull with the slots.
    radius = 21.6 + 0.55 * (13.9 - 21.6)
    length = around(made, "proximal")
    slot = made.ears[0].slot_y
    assert 1.5 * pi * radius < length < 2.0 * pi * radius + 2.0 * slot[1]


@pytest.mark.parametrize(
    ("section", "more", "sentence"),
    [
        (
            {"kind": "stiffness", "EA": "10 N", "EI_yy": "1 N*mm^2"},
            {},
            "rod.section is given by its stiffness and has no shape to be made.",
        ),
        (TUBE, {"rod": {"reference_strain": {"bend_y": "1 1/m"}}}, "is curved or stretched"),
        ({**TUBE, "stretch": 1.1}, {}, "has material that is stretched at rest"),
        ({**TUBE, "wall": "7.2 mm"}, {"actuators": {"air": air()}}, "does not fit its chamber"),
        (
            {
                "kind": "composite",
                "parts": [
                    {"shape": "disc", "radius": "3 mm", "y": "4 mm"},
                    {"shape": "disc", "radius": "3 mm", "y": "-4 mm"},
                ],
            },
            {},
            "has 2 parts that do not touch one another",
        ),
        (
            {
                "kind": "composite",
                "parts": [
                    {"shape": "ring", "radius": 1.0, "wall": 0.3},
                    {"shape": "disc", "radius": 0.5, "cavity": "air"},
                ],
            },
            {},
            'the cavity "air" is not filled up to material all around it',
        ),
    ],
)
def test_what_cannot_be_made_is_refused(section: Any, more: Any, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        body(device(section, **more))
