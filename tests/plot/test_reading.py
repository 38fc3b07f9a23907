"""Conversion to scenes, for a state with known frames and forces."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from flexor.model import ContactForces
from flexor.model.schema import Link, Rod
from flexor.model.schema.actuator import Actuator
from flexor.plot.reading import read_scene

from .synthetic import rod_frames

HEIGHT = np.array([0.012, 0.010, 0.009, 0.0085, 0.008])
FRAMES = rod_frames(0.1, 5.0, (0.0, 0.03), points=5)
LINK_FRAMES = np.stack([np.eye(4), np.eye(4)])
LINK_FRAMES[1, 0, 3] = 0.045


def synthetic_path(lever: float = 1.0, section: object = "circular"):
    rod = {
        "kind": "rod",
        "length": "10 cm",
        "radius": {"base": "1.2 cm", "tip": "0.8 cm"},
        "section": section,
        "young_modulus": "1 MPa",
        "poisson_ratio": 0.5,
        "strain": {"bend_y": {"basis": "nodal_linear"}},
        "elements": 1,
        "gauss_points": 3,
    }
    link = {"kind": "link", "length": "4.5 cm", "radius": {"base": "2 cm", "tip": "1 cm"}}
    slots = {
        "exosuit.radius": HEIGHT,
        "ph_1.radius_base": np.array([0.02]),
        "ph_1.radius_tip": np.array([0.01]),
        "chamber.lever": np.array([0.0, lever]),
    }
    contact = ContactForces(
        first=np.array([0, 1], dtype=np.uint32),
        second=np.array([5, 5], dtype=np.uint32),
        cone=np.array([False, False]),
        force=np.array([[0.0, 0.0, 3.0], [0.0, 0.0, 1.0]]),
        point=np.array([[0.0, 0.0, 0.02], [0.004, 0.0, 0.02]]),
        depth=np.array([0.001, 0.001]),
        pressure=np.array([np.nan, np.nan]),
    )
    exosuit = Rod.model_validate(rod)
    file = SimpleNamespace(
        gravity=SimpleNamespace(components=(0.0, 0.0, 0.0)),
        materials={},
        straps={},
        springs={},
        ties={},
        obstacles={},
        wraps={},
        rod=lambda name: {"exosuit": exosuit}[name],
        bodies={"exosuit": exosuit, "ph_1": Link.model_validate(link)},
        actuators={"chamber": Actuator.model_validate({"kind": "chamber", "rod": "exosuit"})},
    )
    return SimpleNamespace(
        model=SimpleNamespace(file=file, tendons=(), slot=lambda name, parameters: slots[name]),
        parameters=None,
        frames=lambda step: {"exosuit": FRAMES, "ph_1": LINK_FRAMES},
        contact_forces=lambda step: contact,
    )


def test_bodies_have_the_frames_of_the_engine() -> None:
    read = read_scene(synthetic_path())
    (rod,) = read.rods
    every = slice(None, None, (len(rod.frames) - 1) // (len(FRAMES) - 1))
    np.testing.assert_allclose(rod.frames[every], FRAMES, atol=1e-12)
    np.testing.assert_allclose(rod.half_height[every], HEIGHT)
    np.testing.assert_array_equal(rod.half_width, rod.half_height)
    (link,) = read.links
    np.testing.assert_array_equal(link.tip, [0.045, 0.0, 0.0])
    assert (link.radius_base, link.radius_tip) == (0.02, 0.01)


def test_the_width_of_a_section_follows_its_ratio() -> None:
    (rod,) = read_scene(synthetic_path(section={"kind": "elliptic", "ratio": 2.5})).rods
    np.testing.assert_allclose(rod.half_width, 2.5 * rod.half_height)


def test_a_chamber_on_the_surface_runs_along_the_dorsal_edge() -> None:
    (line,) = read_scene(synthetic_path()).lines
    every = slice(None, None, (len(line.points) - 1) // (len(FRAMES) - 1))
    edge = FRAMES[:, :3, 3] + HEIGHT[:, None] * FRAMES[:, :3, 2]
    np.testing.assert_allclose(line.points[every], edge, atol=1e-12)
    assert line.label == "chamber"


def test_a_lever_beyond_the_surface_is_drawn_on_it_and_labelled() -> None:
    (line,) = read_scene(synthetic_path(lever=4.4875)).lines
    np.testing.assert_allclose(line.points, read_scene(synthetic_path()).lines[0].points)
    assert line.label == "chamber (acts at 4.49 S)"


def test_forces_on_one_sphere_of_the_limb_are_summed() -> None:
    (arrow,) = read_scene(synthetic_path()).contact_arrows
    np.testing.assert_allclose(arrow.force, [0.0, 0.0, -4.0])
    assert arrow.point[0] == pytest.approx(0.001)
