"""A printed finger: hinges turn from stop to stop, springs have the stiffness of the joints."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import tomli_w
import trimesh

import flexor
from flexor.errors import InputError
from flexor.export import Finger, FingerOptions, finger, write_solid
from flexor.export.springs import YOUNG_MODULUS, spring_for
from flexor.model import parse
from flexor.model.schema import ModelFile


@pytest.fixture(scope="module")
def file() -> ModelFile:
    return flexor.load("pneumatic-finger").file


@pytest.fixture(scope="module")
def made(file: ModelFile) -> Finger:
    return finger(file)


def overlap(made: Finger, parent: str, child: str, length: float, degrees: float) -> float:
    """Volume that two parts have in common when the child is turned [mm³]."""
    turned = made.parts[child].rotate((0.0, degrees, 0.0)).translate((length, 0.0, 0.0))
    return abs(float((made.parts[parent] ^ turned).volume()))


@pytest.mark.parametrize(
    ("parent", "child", "length", "lower"),
    [("ground", "ph_1", 0.0, -10.0), ("ph_1", "ph_2", 45.0, -5.0), ("ph_2", "ph_3", 25.3, -5.0)],
)
def test_hinges_turn_from_stop_to_stop(
    made: Finger, parent: str, child: str, length: float, lower: float
) -> None:
    # 0.2 degrees for the polygons of round parts.
    for degrees in np.linspace(lower + 0.2, 89.8, 13):
        assert overlap(made, parent, child, length, float(degrees)) < 0.05
    for degrees in (lower - 4.0, 94.0):
        assert overlap(made, parent, child, length, degrees) > 0.2


def test_parts_are_watertight_and_have_the_surface_of_the_model(
    made: Finger, tmp_path: Path
) -> None:
    assert list(made.parts) == ["ground", "ph_1", "ph_2", "ph_3"]
    for name, solid in made.parts.items():
        write_solid(solid, tmp_path / f"{name}.stl")
        mesh = trimesh.load_mesh(tmp_path / f"{name}.stl")
        assert mesh.is_watertight
        assert mesh.volume > 0.0
    # The back of a link is that of its round cone.
    height = made.parts["ph_1"].bounding_box()[5]
    assert height == pytest.approx(21.6, abs=0.2)
    assert made.parts["ph_3"].bounding_box()[3] == pytest.approx(23.6 + 8.7, abs=0.02)


def test_markers_are_on_the_side_of_their_part(made: Finger) -> None:
    for name, dots in made.markers.items():
        assert dots[1][0] - dots[0][0] > 12.0
        for x, y, z in dots:
            solid = made.parts[name]
            # A dot stands out by less than a millimetre.
            assert solid.ray_cast((x, y - 5.0, z), (x, y + 2.0, z))[0].position[1] < y


def test_springs_have_the_stiffness_of_the_joints(made: Finger, file: ModelFile) -> None:
    assert [each.joint for each in made.springs] == ["ph_1", "ph_2", "ph_3"]
    for spring in made.springs:
        link = file.bodies[spring.joint]
        # A wire of the length π D n in bending: k = E I / length.
        inertia = np.pi * spring.wire**4 / 64.0
        bent = YOUNG_MODULUS * inertia / (np.pi * spring.diameter * spring.turns)
        assert bent == pytest.approx(float(link.joint.stiffness), rel=1e-9)
        assert spring.stress == pytest.approx(spring.moment * 0.5 * spring.wire / inertia, rel=1e-9)
        assert spring.moment == pytest.approx(spring.stiffness * np.radians(90.0))


def test_no_spring_of_usual_wire_for_an_extreme_joint() -> None:
    assert spring_for("stiff", 50.0, 1.0, 3e-3, (10e-3, 6e-3)) is None


def changed(file: ModelFile, **fields: object) -> ModelFile:
    return flexor.load(file, changes={key.replace("__", "."): v for key, v in fields.items()}).file


@pytest.mark.parametrize(
    ("fields", "options", "sentence"),
    [
        ({"ph_2__joint__axis": "x"}, {}, "ph_2.joint.axis is not y"),
        ({"ph_2__placement__z": "3 mm"}, {}, "is not placed at the tip of a link"),
        ({"ph_2__joint__stiffness": "60 N*m/rad"}, {}, "no torsion spring of 60 N m/rad fits"),
        ({}, {"pin": 8e-3}, 'the hinge of "ph_2" is too small for a pin of 8 mm'),
    ],
)
def test_what_cannot_be_printed_is_refused(file, fields, options, sentence) -> None:
    document = changed(file, planar=False, **fields) if "ph_2__joint__axis" not in fields else None
    if document is None:
        content = file.to_document()
        content["planar"] = False
        content["bodies"]["ph_2"]["joint"]["axis"] = "x"
        document = parse(tomli_w.dumps(content))
    with pytest.raises(InputError, match=sentence):
        finger(document, FingerOptions(**options))


def test_a_model_without_links_is_refused() -> None:
    with pytest.raises(InputError, match="has no links that could be printed"):
        finger(flexor.load("exosuit-alone").file)


def test_fixed_links_are_one_part(file: ModelFile) -> None:
    content = file.to_document()
    content["bodies"]["ph_3"]["joint"] = {"kind": "fixed"}
    assert list(finger(parse(tomli_w.dumps(content))).parts) == ["ground", "ph_1", "ph_2"]
