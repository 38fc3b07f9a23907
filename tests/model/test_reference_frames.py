"""Poses of bodies in the reference state against SciPy's matrix exponential."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from flexor.model.schema.loop_gap import gap_slopes, gaps
from flexor.model.schema.reference import _exponential


@pytest.mark.parametrize("size", [0.0, 1e-9, 1e-4, 0.1, 0.999, 1.001, 3.0, 7.0])
def test_the_exponential_of_a_twist(size: float) -> None:
    random = np.random.default_rng(1)
    for _ in range(20):
        axis, line = random.normal(size=(2, 3))
        x, y, z = size * axis / np.linalg.norm(axis)
        twist = np.array([[0, -z, y, line[0]], [z, 0, -x, line[1]], [-y, x, 0, line[2]], [0] * 4])
        found = _exponential(np.array([x, y, z, *line]))
        np.testing.assert_allclose(found, expm(twist), atol=2e-14)


def test_the_gap_between_a_point_and_a_link() -> None:
    """It is the least over the link's round cone, and its slopes are those of differences."""
    random = np.random.default_rng(2)
    rows = random.uniform(0.005, 0.02, (200, 6))
    rows[:, 0], rows[:, 5] = random.uniform(-0.02, 0.06, 200), 0.04
    along, y, z, base, tip, length = rows.T[..., None]
    x = np.linspace(0.0, 0.04, 20001)
    each = np.hypot(along - x, np.hypot(y, z)) - base - x / length * (tip - base)
    np.testing.assert_allclose(gaps(rows), each.min(axis=1), atol=1e-10)
    for i, slopes in enumerate(gap_slopes(rows).T):
        step = 1e-7 * np.eye(6)[i]
        difference = (gaps(rows + step) - gaps(rows - step)) / 2e-7
        np.testing.assert_allclose(slopes, difference, atol=1e-7)
