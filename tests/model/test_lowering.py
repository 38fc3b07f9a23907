"""The engine's description of a model file, against numbers worked out by hand."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from flexor.model import ModelFile, parse, read
from flexor.model.lowering import lower
from flexor.model.reading import locate

# Gauss points of three on (0, 1).
GAUSS = [0.5 - 0.5 * math.sqrt(0.6), 0.5, 0.5 + 0.5 * math.sqrt(0.6)]
POINTS = [0.0] + [(e + x) / 10 for e in range(10) for x in (*GAUSS, 1.0)]


def described(name: str, use: str | None = None) -> Any:
    return lower(read(locate(name), use=use))


def test_finger_is_table_1() -> None:
    model = described("finger", "printed")
    assert model["planar"] is True
    assert model["gravity"] == [0.0, 0.0, 0.0]
    exosuit, *links = model["bodies"]
    rod = exosuit["shape"]["rod"]
    assert exosuit["name"] == "exosuit"
    assert exosuit["parent"] is None
    assert exosuit["joint"] == {"kind": "fixed"}
    assert rod["length"] == 0.1
    assert rod["section"] == {"kind": "circular"}
    assert (rod["elements"], rod["gauss_points"], rod["magnus_order"]) == (10, 3, 4)
    assert rod["reference_strain"] == [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]
    assert [(s["mode"], s["basis"]) for s in rod["strain"]] == [
        ("bend_y", "nodal_linear"),
        ("extend_x", "nodal_linear"),
    ]
    assert rod["young_modulus"] == 30_000.0
    assert rod["shear_modulus"] == 10_000.0
    np.testing.assert_allclose(rod["radius"], [0.0116 - 0.0036 * x for x in POINTS], rtol=1e-14)
    np.testing.assert_allclose(rod["slope"], [-0.0036] * 41, rtol=1e-14)
    table = [
        ("ph_1", None, 0.045, 0.0216, 0.0139, 0.04, -10.0),
        ("ph_2", "ph_1", 0.0253, 0.0139, 0.0102, 0.03, -5.0),
        ("ph_3", "ph_2", 0.0236, 0.0102, 0.0087, 0.02, -5.0),
    ]
    for link, (name, parent, length, base, tip, stiffness, lower_limit) in zip(
        links, table, strict=False
    ):
        assert (link["name"], link["parent"]) == (name, parent)
        expected = {"length": length, "radius_base": base, "radius_tip": tip, "density": 0.0}
        assert link["shape"] == {"link": expected}
        assert link["joint"] == {
            "kind": "revolute",
            "axis": [0.0, 1.0, 0.0],
            "stiffness": [stiffness],
            "rest": [0.0],
            "lower": [math.radians(lower_limit)],
            "upper": [math.pi / 2.0],
            "limit_stiffness": 10.0,
            "limit_width": math.radians(1.0),
        }
    tip = links[3]
    assert (tip["name"], tip["parent"], tip["joint"]) == ("tip", "ph_3", {"kind": "fixed"})
    assert tip["shape"]["link"] == {
        "length": 0.001,
        "radius_base": 0.0087,
        "radius_tip": 0.008,
        "density": 0.0,
    }


def test_finger_has_the_papers_spheres() -> None:
    exosuit, finger = described("finger")["spheres"]
    stations = [sphere["station"] for sphere in exosuit["spheres"]]
    assert stations == [{"point": 0}] + [{"point": i} for i in range(41)]
    assert {sphere["body"] for sphere in exosuit["spheres"]} == {"exosuit"}
    assert [(s["body"], s["station"]) for s in finger["spheres"]] == [
        (body, station)
        for body in ("ph_1", "ph_2", "ph_3", "tip")
        for station in ({"fraction": 0.0}, "centroid")
    ]
    (contact,) = described("finger")["contacts"]
    assert (contact["first"], contact["second"]) == ("exosuit", "finger")
    assert contact["tip_spheres"] == [41]


@pytest.mark.parametrize(
    ("use", "modulus", "lever", "stiffness"),
    [
        ("printed", 30e3, 1.0, 1000.0),
        ("surface", 361.1e3, 1.0, 361.2),
        ("calibrated", 2.2285e6, 4.4875, 77.1),
        ("calibrated-optimum", 371.86e3, 1.09926, 446.33),
    ],
)
def test_sets_of_constants(use: str, modulus: float, lever: float, stiffness: float) -> None:
    model = described("finger", use)
    assert model["bodies"][0]["shape"]["rod"]["young_modulus"] == modulus
    assert model["bodies"][0]["placement"]["translation"] == [0.0, 0.0, 0.0216 + 0.0116]
    assert model["contacts"][0]["stiffness"] == stiffness
    (chamber,) = model["actuators"]
    assert (chamber["kind"], chamber["rod"], chamber["lever"]) == ("chamber", "exosuit", [0, lever])
    assert chamber["path"] == chamber["path_slope"] == [[0.0, 0.0]] * 41


def test_surface_is_the_default_everywhere() -> None:
    for name in ("finger", "finger-2-links", "exosuit-alone"):
        assert described(name) == described(name, "surface") != described(name, "printed")


def test_two_links_merge_the_first_two() -> None:
    three, two = described("finger"), described("finger-2-links")
    assert two["bodies"][0] == three["bodies"][0]
    merged, last, tip = two["bodies"][1:]
    assert merged["shape"]["link"]["length"] == pytest.approx(0.0703, rel=1e-15)
    assert merged["shape"]["link"]["radius_base"] == 0.0216
    assert merged["shape"]["link"]["radius_tip"] == 0.0102
    assert merged["joint"] == three["bodies"][1]["joint"]
    assert last == {**three["bodies"][3], "parent": "ph_12"}
    assert tip == three["bodies"][4]
    assert [len(group["spheres"]) for group in two["spheres"]] == [42, 6]
    for key in ("actuators", "contacts"):
        assert two[key] == three[key]


def test_exosuit_alone_is_the_finger_without_one() -> None:
    finger, alone = described("finger"), described("exosuit-alone")
    assert alone["bodies"] == finger["bodies"][:1]
    assert alone["actuators"] == finger["actuators"]
    assert not {"contacts", "spheres"} & set(alone)  # empty lists are left out


def test_tendon_arm_is_the_spatial_reference() -> None:
    model = described("tendon-arm")
    rod = model["bodies"][0]["shape"]["rod"]
    modes = ["twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z"]
    assert [(s["mode"], s["basis"]) for s in rod["strain"]] == [
        (m, "nodal_quadratic") for m in modes
    ]
    assert (rod["length"], rod["density"]) == (0.25, 1000.0)
    assert rod["radius"][0] == 0.012
    assert rod["radius"][-1] == pytest.approx(0.006, rel=1e-15)
    assert rod["shear_modulus"] == pytest.approx(200e3 / 3.0, rel=1e-15)
    assert model["gravity"] == [0.0, 0.0, -9.81]
    (tendon,) = model["actuators"]
    gauss = np.polynomial.legendre.leggauss(4)[0] / 2.0 + 0.5
    X = np.array([0.0] + [(e + x) / 3 for e in range(3) for x in (*gauss, 1.0)])
    path = 0.004 * np.stack([np.cos(2.0 * X), np.sin(2.0 * X)], axis=1)
    slope = 0.008 * np.stack([-np.sin(2.0 * X), np.cos(2.0 * X)], axis=1)
    np.testing.assert_allclose(tendon["path"], path, atol=1e-17)
    np.testing.assert_allclose(tendon["path_slope"], slope, atol=1e-17)
    assert tendon["lever"] == [0.0, 0.0]


ARM = """
name = "arm"

[bodies.hand]
kind = "link"
parent = "arm"
length = "4 cm"
radius = "1 cm"
joint = { kind = "prismatic", axis = [3, 0, 4], upper = "1 cm" }

[bodies.arm]
kind = "rod"
length = "10 cm"
radius = ["1 cm", "2 cm", "1.5 cm"]
section = { kind = "rectangular", ratio = 2.0 }
young_modulus = "3 MPa"
poisson_ratio = 0.25
strain = { shear_z = "nodal_linear", twist_x = { basis = "legendre", order = 2 } }
reference_strain = { bend_y = "2 1/m", shear_z = 0.1 }
elements = 4
gauss_points = 2
placement = { x = "1 cm", rotation = { x = "90 deg" }, reference = "underside" }

[spheres.all]
bodies = ["hand"]
points = [{ body = "arm", at = "tip" }, { body = "arm", at = 0.75 }, { body = "hand", at = 0.5 }]

[contacts.self]
first = "all"
second = "all"
stiffness = "1 N/mm"
skip = 2

[actuators.cable]
kind = "cable"
rod = "arm"
path = { y = "1 mm", z = ["0 mm", "2 mm"] }
lever = { y = 0.5 }

[springs.strap]
first = { body = "hand", at = "tip", offset = { z = "1 cm" } }
second = { world = { x = "1 m" } }
stiffness = "10 N/m"
rest_length = "5 cm"
slack = true

[wrenches.push]
body = "arm"
point = 5
force = { z = "-1 N" }
moment = { y = "2 N*mm" }
frame = "body"
input = true
"""


@pytest.fixture(scope="module")
def arm() -> Any:
    return lower(parse(ARM))


def test_parents_come_first(arm: Any) -> None:
    assert [body["name"] for body in arm["bodies"]] == ["arm", "hand"]


def test_strain_modes_come_in_the_order_of_the_twist(arm: Any) -> None:
    rod = arm["bodies"][0]["shape"]["rod"]
    assert rod["strain"] == [
        {"mode": "twist_x", "basis": "legendre", "order": 2},
        {"mode": "shear_z", "basis": "nodal_linear", "order": 0},
    ]
    assert rod["reference_strain"] == [0.0, 2.0, 0.0, 1.0, 0.0, 0.1]
    assert rod["section"] == {"kind": "rectangular", "ratio": 2.0}
    assert rod["shear_modulus"] == 1.2e6


def test_sampled_radius_meets_its_samples_with_its_own_slope(arm: Any) -> None:
    rod = arm["bodies"][0]["shape"]["rod"]
    radius = np.array(rod["radius"])
    assert len(radius) == len(rod["slope"]) == 13
    assert radius[[0, 6, 12]].tolist() == pytest.approx([0.01, 0.02, 0.015], rel=1e-15)
    assert radius.min() >= 0.01
    assert radius.max() <= 0.02
    # Through a turn of its samples a monotone cubic is level.
    assert rod["slope"][6] == pytest.approx(0.0, abs=1e-15)
    assert all(slope > 0.0 for slope in rod["slope"][:6])
    assert all(slope < 0.0 for slope in rod["slope"][7:])


def test_underside_is_along_the_turned_dorsal_axis(arm: Any) -> None:
    # Turned by 90 deg about x, dorsal is -y.
    place = arm["bodies"][0]["placement"]
    assert place["translation"] == pytest.approx([0.01, -0.01, 0.0], abs=1e-17)
    assert place["rotation"] == [math.pi / 2.0, 0.0, 0.0]


def test_prismatic_joint_has_a_unit_axis_and_one_limit(arm: Any) -> None:
    joint = arm["bodies"][1]["joint"]
    assert joint["axis"] == pytest.approx([0.6, 0.0, 0.8])
    assert joint["lower"] == [None]
    assert joint["upper"] == [0.01]


def test_places(arm: Any) -> None:
    (group,) = arm["spheres"]
    assert group["spheres"] == [
        {"body": "hand", "station": {"fraction": 0.0}},
        {"body": "hand", "station": "centroid"},
        {"body": "arm", "station": {"point": 12}},
        {"body": "arm", "station": {"point": 9}},
        {"body": "hand", "station": {"fraction": 0.5}},
    ]
    assert arm["contacts"] == [
        {
            "name": "self",
            "first": "all",
            "second": "all",
            "stiffness": 1000.0,
            "skip": 2,
            "tip_spheres": [],
        }
    ]
    assert arm["springs"] == [
        {
            "name": "strap",
            "first": {"body": "hand", "station": {"fraction": 1.0}, "offset": [0.0, 0.0, 0.01]},
            "second": {"world": [1.0, 0.0, 0.0]},
            "stiffness": 10.0,
            "rest_length": 0.05,
            "slack": True,
        }
    ]
    assert arm["wrenches"] == [
        {
            "name": "push",
            "at": {"body": "arm", "station": {"point": 5}, "offset": [0.0, 0.0, 0.0]},
            "force": [0.0, 0.0, -1.0],
            "moment": [0.0, 0.002, 0.0],
            "frame": "body",
            "input": True,
        }
    ]


def test_cable_beside_the_axis(arm: Any) -> None:
    (cable,) = arm["actuators"]
    path = np.array(cable["path"])
    X = np.linspace(0.0, 1.0, 13)[[0, 3, 6, 9, 12]]
    np.testing.assert_allclose(path[:, 0], 0.001)
    np.testing.assert_allclose(path[[0, 3, 6, 9, 12], 1], 0.002 * X, atol=1e-17)
    np.testing.assert_allclose(cable["path_slope"], [[0.0, 0.002]] * 13, atol=1e-17)
    assert cable["lever"] == [0.5, 0.0]


def test_description_does_not_depend_on_the_units() -> None:
    def lengths(text: str) -> ModelFile:
        return parse(ARM.replace('length = "10 cm"', f'length = "{text}"'))

    assert lower(lengths("10 cm")) == lower(lengths("0.1 m")) == lower(lengths("100 mm"))
