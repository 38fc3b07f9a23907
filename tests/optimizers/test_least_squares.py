"""Levenberg-Marquardt: exact Jacobians, batches, bounds and local minima."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares

from flexor.optimizers import Budget, LevenbergMarquardt

LOWER, UPPER = np.array([-2.0, -1.5]), np.array([2.0, 3.0])


class Rosenbrock:
    """As a sum of squares (More, Garbow and Hillstrom 1981, problem 1)."""

    def __init__(self) -> None:
        self.batches: list[int] = []

    def residuals(self, x: np.ndarray) -> np.ndarray:
        return np.stack((10.0 * (x[:, 1] - x[:, 0] ** 2), 1.0 - x[:, 0]), axis=1)

    def __call__(self, x: np.ndarray) -> np.ndarray:
        self.batches.append(len(x))
        return np.linalg.norm(self.residuals(x), axis=1)


class Differentiable(Rosenbrock):
    def jacobian(self, x: np.ndarray) -> np.ndarray:
        rows = np.zeros((len(x), 2, 2))
        rows[:, 0, 0], rows[:, 0, 1], rows[:, 1, 0] = -20.0 * x[:, 0], 10.0, -1.0
        return rows


def test_rosenbrock_by_differences_and_by_its_jacobian() -> None:
    by_differences, by_jacobian = (
        LevenbergMarquardt().minimize(kind(), LOWER, UPPER, [-1.2, 1.0])
        for kind in (Rosenbrock, Differentiable)
    )
    np.testing.assert_allclose(by_differences.design, [1.0, 1.0], atol=1e-5)
    np.testing.assert_allclose(by_jacobian.design, [1.0, 1.0], atol=1e-5)
    # The same steps, without the two designs for each set of differences.
    assert by_jacobian.iterations == pytest.approx(by_differences.iterations, abs=2)
    assert by_jacobian.evaluations < 0.5 * by_differences.evaluations


def test_an_optimum_on_a_bound_agrees_with_scipy() -> None:
    lower, upper = LOWER, np.array([0.5, 0.2])
    for start in ([-1.2, -1.0], [0.5, 0.2], [-2.0, 0.2], [0.0, 0.0]):
        ours = LevenbergMarquardt().minimize(Rosenbrock(), lower, upper, start)
        theirs = least_squares(
            lambda x: Rosenbrock().residuals(x[None])[0], [0.1, 0.0], bounds=(lower, upper)
        )
        np.testing.assert_allclose(ours.design, theirs.x, atol=1e-4)
        assert ours.value == pytest.approx(np.sqrt(2.0 * theirs.cost), rel=1e-7)


def test_starts_are_batched() -> None:
    function = Rosenbrock()
    found = LevenbergMarquardt(starts=8).minimize(function, LOWER, UPPER, seed=2)
    assert function.batches[:3] == [8, 16, 8]
    assert found.value < 1e-6


def test_local_minima_trap_it_as_reported_in_the_paper() -> None:
    class Multimodal(Rosenbrock):
        def residuals(self, x: np.ndarray) -> np.ndarray:
            return 3.0 + 0.5 * x + 0.3 * np.sin(25.0 * x)

    ends = [
        LevenbergMarquardt().minimize(Multimodal(), LOWER, UPPER, seed=seed).value
        for seed in range(10)
    ]
    best = LevenbergMarquardt(starts=400).minimize(Multimodal(), LOWER, UPPER, seed=0).value
    assert np.ptp(ends) > 0.5
    assert best < min(ends) + 1e-9


def test_differences_are_taken_inwards_at_the_upper_bound() -> None:
    requested: list[np.ndarray] = []

    class Recording(Rosenbrock):
        def __call__(self, x: np.ndarray) -> np.ndarray:
            requested.append(x)
            return super().__call__(x)

    LevenbergMarquardt().minimize(Recording(), LOWER, UPPER, UPPER, budget=Budget(evaluations=3))
    assert requested[0].tolist() == [UPPER.tolist()]
    np.testing.assert_allclose(UPPER - requested[1], np.diag(1e-6 * (UPPER - LOWER)), rtol=1e-6)


def test_a_parameter_whose_difference_fails_is_held() -> None:
    class Fails(Rosenbrock):
        def residuals(self, x: np.ndarray) -> np.ndarray:
            vectors = super().residuals(x)
            vectors[x[:, 0] > -1.2] = np.nan
            return vectors

    found = LevenbergMarquardt().minimize(Fails(), LOWER, UPPER, [-1.2, 1.0])
    assert found.design[0] <= -1.2
    assert found.design[1] == pytest.approx(1.44, abs=1e-3)
