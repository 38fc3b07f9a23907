"""An imported limb in postures of MuJoCo, with numbers that MuJoCo gave once."""

from __future__ import annotations

import json

import numpy as np
import pytest

from .postures import REFERENCE, Imported


@pytest.fixture(scope="module")
def imported() -> Imported:
    return Imported.of(REFERENCE / "limb.xml")


def test_bodies_tendons_and_moment_arms(imported: Imported) -> None:
    postures = json.loads((REFERENCE / "limb.json").read_text(encoding="utf-8"))["postures"]
    assert len(postures) == 20
    for each in postures:
        q = imported.coordinates(each["posture"])
        for name, pose in imported.places(q).items():
            assert np.allclose(pose, each["bodies"][name], rtol=0.0, atol=1e-12), name
        lengths = imported.lengths(q)
        assert lengths == pytest.approx(each["lengths"], abs=1e-12)
        for tendon, arms in each["arms"].items():
            for joint, arm in arms.items():
                # MuJoCo iterates paths that pass inside a wrap to 1e-6 of its angles.
                assert imported.arms(q, joint)[tendon][0] == pytest.approx(arm, abs=1e-8)


def test_what_is_carried_over(imported: Imported) -> None:
    file = imported.model.file
    kinds = {name: tendon.kind for name, tendon in file.tendons.items()}
    assert kinds == {
        "extensor": "muscle",
        "flexor": "spring",
        "lumbrical": "cable",
    }
    assert {name: wrap.kind for name, wrap in file.wraps.items()} == {
        "post": "cylinder",
        "mcp_pulley": "cylinder",
        "pip_knuckle": "sphere",
        "carpal_ring": "sphere",
    }
    joint = file.bodies["palm_1"].joint
    assert joint.kind == "revolute"
    assert float(joint.stiffness) == 0.2
    degrees = [np.degrees(float(x)) for x in (joint.rest, joint.lower, joint.upper)]
    assert degrees == pytest.approx([5.0, -65.0, 55.0])
    assert file.bodies["proximal"].joint.kind == "spherical"
    capsule = file.bodies["proximal_shape"]
    assert (float(capsule.length), float(capsule.radius.base)) == (0.03, 0.008)
    assert file.spheres["limb"].bodies == ("palm_shape", "proximal_shape", "tip")
    assert file.gravity.components == (0.1, 0.0, -9.8)
    left_out = dict(imported.limb.left_out)
    assert left_out == {
        "damping of joints": 5,
        "<inertial>": 1,
        "equality constraint <joint>": 1,
    }


def test_capsules_are_where_they_were(imported: Imported) -> None:
    """At rest: of the palm from its ends, of the proximal one along its turned axis."""
    frames = imported.model.engine.frames(imported.model.parameters, np.zeros(imported.model.dof))

    def ends(name: str) -> np.ndarray:
        start, stop = imported.model.body_frames[name]
        return frames[[start, stop - 1], :3, 3]

    places = imported.places(np.zeros(imported.model.dof))
    for name, body, expected in (
        ("palm_shape", "palm", [[0.0, 0.0, 0.0], [0.06, 0.01, 0.0]]),
        ("proximal_shape", "proximal", [[0.005, 0.0, 0.0], [0.035, 0.0, 0.0]]),
    ):
        pose = places[body]
        world = np.array(expected) @ pose[:, :3].T + pose[:, 3]
        found = ends(name)
        same = np.allclose(found, world, atol=1e-12) or np.allclose(found, world[::-1], atol=1e-12)
        assert same, name
