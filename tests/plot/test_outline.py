from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexor.plot.outline import band, capsule, refine, tube

from .synthetic import rod_frames

coordinate = st.floats(-0.2, 0.2)
radius = st.floats(0.001, 0.05)


def area(outline: np.ndarray) -> float:
    x, y = outline.T
    return 0.5 * abs(float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])))


def test_band_of_a_straight_rod_is_its_trapezium() -> None:
    x = np.linspace(0.0, 0.1, 11)
    centre = np.stack([x, np.full_like(x, 0.03)], axis=1)
    outline = band(centre, np.tile([0.0, 1.0], (11, 1)), np.linspace(0.012, 0.008, 11))
    assert outline.shape == (23, 2)
    np.testing.assert_array_equal(outline[0], outline[-1])
    np.testing.assert_allclose(outline[0], [0.0, 0.042])
    np.testing.assert_allclose(outline[10], [0.1, 0.038])
    np.testing.assert_allclose(outline[11], [0.1, 0.022])
    assert area(outline) == pytest.approx(0.1 * (0.024 + 0.016) / 2.0)


def test_capsule_of_equal_discs_is_a_stadium() -> None:
    outline = capsule([0.0, 0.0], [0.05, 0.0], 0.01, 0.01, arc_points=2000)
    assert area(outline) == pytest.approx(0.05 * 0.02 + np.pi * 0.01**2, rel=1e-5)


@given(st.tuples(coordinate, coordinate), st.tuples(coordinate, coordinate), radius, radius)
def test_capsule_is_the_convex_hull_of_both_discs(a, b, r_a, r_b) -> None:
    a, b = np.array(a), np.array(b)
    outline = capsule(a, b, r_a, r_b, arc_points=200)
    np.testing.assert_allclose(outline[0], outline[-1], atol=1e-12)
    angle = np.linspace(0.0, 2.0 * np.pi, 73)
    for heading in np.stack([np.cos(angle), np.sin(angle)], axis=1):
        # The farthest point in a direction is that of the farther disc.
        expected = max(a @ heading + r_a, b @ heading + r_b)
        reach = float(np.max(outline @ heading))
        assert reach <= expected + 1e-12
        assert reach >= expected - 1e-3 * max(r_a, r_b)


def test_capsule_of_a_disc_inside_another_is_the_larger_circle() -> None:
    outline = capsule([0.001, 0.0], [0.0, 0.0], 0.002, 0.01)
    np.testing.assert_allclose(np.hypot(*outline.T), 0.01)


def test_tube_has_constant_distance_from_its_axis() -> None:
    s = np.linspace(0.0, 1.0, 5)[:, None]
    x, y, z = tube(s * [[1.0, 0.0, 0.0]], 0.0 * s + [[0.0, 2.0, 0.0]], 0.0 * s + [[0.0, 0.0, 3.0]])
    np.testing.assert_allclose((y / 2.0) ** 2 + (z / 3.0) ** 2, 1.0)
    np.testing.assert_allclose(x, np.repeat(s, x.shape[1], axis=1))


def test_refined_frames_of_an_arc_stay_on_its_circle() -> None:
    coarse = rod_frames(0.1, 30.0, (0.0, 0.0), points=9)
    fine, station = refine(coarse, between=5)
    assert len(fine) == 41
    np.testing.assert_allclose(fine[::5], coarse, atol=1e-12)
    np.testing.assert_allclose(station[::5], np.arange(9))
    # 21 degrees from frame to frame: the curve between leaves the circle by microns.
    exact = rod_frames(0.1, 30.0, (0.0, 0.0), points=41)
    np.testing.assert_allclose(fine[:, :3, 3], exact[:, :3, 3], atol=1e-4)
    np.testing.assert_allclose(fine[:, :3, :3], exact[:, :3, :3], atol=2e-3)
    radius = np.hypot(fine[:, 0, 3], fine[:, 2, 3] + 1.0 / 30.0)
    np.testing.assert_allclose(radius, 1.0 / 30.0, rtol=1e-3)
