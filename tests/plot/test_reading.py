"""The reader of scenes, on a state whose places and forces are written down by hand."""

from __future__ import annotations

import numpy as np
import pytest

from flexor.plot.reading import read_scene

from .made import rod_frames

HEIGHT = np.array([0.012, 0.010, 0.008])
FRAMES = rod_frames(0.1, 5.0, (0.0, 0.03), points=3)


class ByHand:
    """A rod of three points over a link, with one sphere of the link pressed by two of the rod."""

    slots = {
        "exosuit.radius": (0, 3),
        "ph_1.radius_base": (3, 4),
        "ph_1.radius_tip": (4, 5),
        "chamber.lever": (5, 7),
    }

    def __init__(self, lever: float = 1.0) -> None:
        self.parameters = np.array([*HEIGHT, 0.02, 0.01, 0.0, lever])

    def frame_names(self) -> list[str]:
        return ["exosuit[0]", "exosuit[1]", "exosuit[2]", "ph_1.joint", "ph_1.tip"]

    def frames(self, parameters, q):
        base, tip = np.eye(4), np.eye(4)
        tip[0, 3] = 0.045
        return np.concatenate([FRAMES, [base, tip]])

    def spheres(self, parameters, q):
        return np.array([[0.0, 0.0, 0.03, 0.012], [0.01, 0.0, 0.03, 0.012], [0.0, 0.0, 0.0, 0.02]])

    def contacts(self, parameters, q):
        return {
            "first": np.array([0, 1]),
            "second": np.array([2, 2]),
            "force": np.array([[0.0, 0.0, 3.0], [0.5, 0.0, 1.0]]),
            "depth": np.array([0.002, 0.001]),
        }


def description(section: dict[str, object] | None = None) -> dict[str, object]:
    return {
        "bodies": [
            {"name": "exosuit", "shape": {"rod": {"section": section or {"kind": "circular"}}}},
            {"name": "ph_1", "shape": {"link": {}}},
        ],
        "actuators": [{"name": "chamber", "kind": "chamber", "rod": "exosuit", "path": [[0, 0]] * 3}],
    }


def scene(lever: float = 1.0, section: dict[str, object] | None = None):
    engine = ByHand(lever)
    return read_scene(engine, description(section), engine.parameters, np.zeros(1))


def test_bodies_are_where_the_engine_puts_them() -> None:
    read = scene()
    (rod,) = read.rods
    np.testing.assert_array_equal(rod.frames, FRAMES)
    np.testing.assert_array_equal(rod.half_height, HEIGHT)
    np.testing.assert_array_equal(rod.half_width, HEIGHT)
    (link,) = read.links
    np.testing.assert_array_equal(link.tip, [0.045, 0.0, 0.0])
    assert (link.radius_base, link.radius_tip) == (0.02, 0.01)


def test_a_wide_section_is_as_wide_as_its_ratio_says() -> None:
    (rod,) = scene(section={"kind": "elliptic", "ratio": 2.5}).rods
    np.testing.assert_allclose(rod.half_width, 2.5 * HEIGHT)


def test_a_chamber_on_the_surface_runs_along_the_dorsal_edge() -> None:
    (line,) = scene().lines
    np.testing.assert_allclose(line.points, FRAMES[:, :3, 3] + HEIGHT[:, None] * FRAMES[:, :3, 2])
    assert line.label == "chamber"


def test_a_lever_beyond_the_surface_is_drawn_on_it_and_named() -> None:
    (line,) = scene(lever=4.4875).lines
    np.testing.assert_allclose(line.points, scene().lines[0].points)
    assert line.label == "chamber (acts at 4.49 S)"


def test_forces_on_one_sphere_of_the_limb_become_one_arrow_into_it() -> None:
    (push,) = scene().pushes
    np.testing.assert_allclose(push.force, [-0.5, 0.0, -4.0])
    # Both touching points lie halfway into the overlap, on the sphere of radius 2 cm about 0.
    reach = np.linalg.norm(push.point)
    assert 0.018 < reach < 0.02
    assert push.point[0] == pytest.approx(0.0195 * np.sin(np.arctan2(1, 3)) * 1.118 / 4.118, rel=1e-3)
