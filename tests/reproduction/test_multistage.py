"""The multistage search on functions whose minimum is known."""

from __future__ import annotations

import numpy as np
import pytest

from reproduction.multistage import MultistageSearch

ZEROS, ONES = np.zeros(3), np.ones(3)


def bowl(designs: np.ndarray) -> np.ndarray:
    return np.sum((designs - 0.3) ** 2, axis=1)


def island(designs: np.ndarray) -> np.ndarray:
    """A bowl with a small, deeper minimum on the face x = 1."""
    x, y, z = designs.T
    on_it = (x > 0.98) & (np.abs(y - 0.62) < 0.06) & (np.abs(z - 0.21) < 0.06)
    deep = -1.0 + (y - 0.64) ** 2 + (z - 0.2) ** 2 + (1.0 - x)
    return np.where(on_it, deep, bowl(designs))


def cliff(designs: np.ndarray) -> np.ndarray:
    """Decreases towards a discontinuity oblique to the axes; the minimum is on its edge."""
    x, y, _ = designs.T
    return np.where(x + y < 0.7, 2.0, 0.1 * x + y)


def test_a_bowl() -> None:
    found = MultistageSearch(1000).minimize(bowl, ZEROS, ONES, seed=3)
    np.testing.assert_allclose(found.design, 0.3, atol=1e-3)
    assert found.evaluations <= 1300


@pytest.mark.parametrize("seed", range(2))
def test_an_island_on_a_face(seed: int) -> None:
    # A uniform sample of the same size hits the island with a probability of one in seven.
    found = MultistageSearch(4000).minimize(island, ZEROS, ONES, seed=seed)
    assert found.value == pytest.approx(-1.0, abs=1e-4)


def test_the_edge_of_a_cliff_is_followed() -> None:
    found = MultistageSearch(2000).minimize(cliff, ZEROS, ONES, seed=0)
    # On the edge y = 0.7 - x the value is 0.7 - 0.9 x, least at x = 0.7.
    assert found.value == pytest.approx(0.07, abs=2e-3)


def test_the_result_is_never_worse_than_a_start() -> None:
    def needle(designs: np.ndarray) -> np.ndarray:
        at_it = np.all(designs == np.array([0.1, 0.2, 0.3]), axis=1)
        return np.where(at_it, -5.0, bowl(designs))

    found = MultistageSearch(300).minimize(
        needle, ZEROS, ONES, start=[[0.5, 0.5, 0.5], [0.1, 0.2, 0.3]]
    )
    assert found.value == -5.0


def test_the_same_seed_evaluates_the_same_designs() -> None:
    evaluated: list[list[np.ndarray]] = []
    for _ in range(2):
        seen: list[np.ndarray] = []

        def function(designs: np.ndarray, seen: list[np.ndarray] = seen) -> np.ndarray:
            seen.append(designs.copy())
            return island(designs)

        MultistageSearch(500).minimize(function, ZEROS, ONES, seed=11)
        evaluated.append(seen)
    assert len(evaluated[0]) == len(evaluated[1])
    for first, second in zip(*evaluated, strict=True):
        np.testing.assert_array_equal(first, second)


def test_failed_designs_are_tolerated() -> None:
    def failing(designs: np.ndarray) -> np.ndarray:
        return np.where(designs[:, 0] > 0.5, np.inf, bowl(designs))

    found = MultistageSearch(800).minimize(failing, ZEROS, ONES, seed=1)
    np.testing.assert_allclose(found.design, 0.3, atol=1e-3)
