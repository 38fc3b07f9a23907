"""The thorough search on functions whose minimum is known."""

from __future__ import annotations

import numpy as np
import pytest

from reproduction.thorough import Thorough

ZEROS, ONES = np.zeros(3), np.ones(3)


def bowl(designs: np.ndarray) -> np.ndarray:
    return np.sum((designs - 0.3) ** 2, axis=1)


def island(designs: np.ndarray) -> np.ndarray:
    """A bowl, and on the face x = 1 a small island that lies deeper."""
    x, y, z = designs.T
    on_it = (x > 0.98) & (np.abs(y - 0.62) < 0.06) & (np.abs(z - 0.21) < 0.06)
    deep = -1.0 + (y - 0.64) ** 2 + (z - 0.2) ** 2 + (1.0 - x)
    return np.where(on_it, deep, bowl(designs))


def cliff(designs: np.ndarray) -> np.ndarray:
    """Falls towards a cliff that is oblique to the axes; the best is where it meets x = 0."""
    x, y, _ = designs.T
    return np.where(x + y < 0.7, 2.0, 0.1 * x + y)


def test_a_bowl() -> None:
    found = Thorough(1000).minimize(bowl, ZEROS, ONES, seed=3)
    np.testing.assert_allclose(found.design, 0.3, atol=1e-3)
    assert found.evaluations <= 1300


@pytest.mark.parametrize("seed", range(2))
def test_an_island_on_a_face(seed: int) -> None:
    # A uniform sample of the same size has a point on it once in seven times.
    found = Thorough(4000).minimize(island, ZEROS, ONES, seed=seed)
    assert found.value == pytest.approx(-1.0, abs=1e-4)


def test_the_edge_of_a_cliff_is_followed() -> None:
    found = Thorough(2000).minimize(cliff, ZEROS, ONES, seed=0)
    # On the edge y = 0.7 - x the value is 0.7 - 0.9 x, least at x = 0.7.
    assert found.value == pytest.approx(0.07, abs=2e-3)


def test_a_start_is_never_left_for_worse() -> None:
    def needle(designs: np.ndarray) -> np.ndarray:
        at_it = np.all(designs == np.array([0.1, 0.2, 0.3]), axis=1)
        return np.where(at_it, -5.0, bowl(designs))

    found = Thorough(300).minimize(needle, ZEROS, ONES, start=[[0.5, 0.5, 0.5], [0.1, 0.2, 0.3]])
    assert found.value == -5.0


def test_the_same_seed_asks_for_the_same_designs() -> None:
    asked: list[list[np.ndarray]] = []
    for _ in range(2):
        seen: list[np.ndarray] = []

        def function(designs: np.ndarray, seen: list[np.ndarray] = seen) -> np.ndarray:
            seen.append(designs.copy())
            return island(designs)

        Thorough(500).minimize(function, ZEROS, ONES, seed=11)
        asked.append(seen)
    assert len(asked[0]) == len(asked[1])
    for first, second in zip(*asked, strict=True):
        np.testing.assert_array_equal(first, second)


def test_failed_designs_are_gone_around() -> None:
    def failing(designs: np.ndarray) -> np.ndarray:
        return np.where(designs[:, 0] > 0.5, np.inf, bowl(designs))

    found = Thorough(800).minimize(failing, ZEROS, ONES, seed=1)
    np.testing.assert_allclose(found.design, 0.3, atol=1e-3)
