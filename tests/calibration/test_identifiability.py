"""Identifiability of constants in linear least squares, where it is known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from flexor.calibration.constants import Constant
from flexor.calibration.identifiability import (
    Direction,
    Identifiability,
    local_identifiability,
    profile_likelihood,
)
from flexor.calibration.local_fit import Minimum, distinct, fit_locally
from flexor.calibration.screening import screen
from flexor.errors import InputError
from flexor.model.quantity import Unit


def constant(name: str, low: float = 1.0, high: float = 100.0, log: bool = True) -> Constant:
    return Constant(name, ("a.b",), low, high, log, Unit())


class Linear:
    """Residuals A (u - u0), as an evaluator would give them."""

    def __init__(self, matrix, solution, **constants) -> None:
        self.A, self.solution = np.array(matrix, float), np.array(solution, float)
        names = [f"c{i}" for i in range(self.A.shape[1])]
        self.problem = self
        self.constants = tuple(constant(name, **constants) for name in names)
        self.needs_optima, self.path_runs, self.fitted_runs = False, (0,), (0,)
        self.evaluated = 0

    def residuals(self, u, runs, threads=0):
        self.evaluated += len(u)
        return (u - self.solution) @ self.A.T

    def jacobian(self, u, columns, runs):
        return self.A[:, list(columns)]

    def misfit(self, u, runs, worst=np.inf):
        found = (self.residuals(u, runs) ** 2).sum(axis=1)
        return np.where(found > worst, np.inf, found)


def test_a_constant_is_known_as_well_as_the_data_allow() -> None:
    A = np.array([[200.0, 10.0], [30.0, 90.0], [5.0, 40.0]])
    problem = Linear(A, [0.4, 0.6])
    minimum = fit_locally(problem, np.array([0.1, 0.9]))
    np.testing.assert_allclose(minimum.u, [0.4, 0.6], atol=1e-6)
    known = local_identifiability(problem, minimum)
    # Next to data this sharp the range itself adds nothing.
    exact = np.sqrt(np.diag(np.linalg.inv(A.T @ A)))
    np.testing.assert_allclose(known.deviation, exact, rtol=1e-2)
    assert [known.verdict(i) for i in range(2)] == ["identifiable"] * 2
    for i in range(2):
        found = profile_likelihood(problem, minimum, i, known.deviation[i])
        np.testing.assert_allclose(
            found.interval(), minimum.u[i] + np.array([-1.96, 1.96]) * exact[i], rtol=5e-3
        )


def test_two_constants_that_act_as_one_are_known_only_together() -> None:
    problem = Linear([[100.0, 100.0, 0.0], [0.0, 0.0, 1.0]], [0.5, 0.5, 0.5])
    known = local_identifiability(problem, Minimum(np.array([0.5, 0.5, 0.5]), np.zeros(2)))
    assert known.verdict(0) == known.verdict(1) == "only in combination"
    assert known.verdict(2) == "not identifiable"
    best, _, worst = known.directions
    np.testing.assert_allclose(np.abs(best.weights), [np.sqrt(0.5), np.sqrt(0.5), 0.0], atol=1e-9)
    assert known.describe(best).startswith(("c0 · c1 to ±", "c1 · c0 to ±"))
    assert best.deviation == pytest.approx(1.0 / np.sqrt(2.0 * 100.0**2), rel=1e-3)
    # What no data say anything of is known as well as its range.
    assert worst.deviation == pytest.approx(np.sqrt(1.0 / 12.0), rel=1e-6)


def test_a_direction_names_its_powers_and_its_spread() -> None:
    free = (constant("E", 1.0, 10.0), constant("k", 1.0, 1000.0))
    u = np.array([0.5, 0.5])
    known = Identifiability(free, u, np.eye(2), np.ones(2), np.ones(2), ())
    # ln E / ln 10 and ln k / ln 1000 in equal parts: E k^(1/3).
    direction = Direction(np.array([1.0, 1.0]) / np.sqrt(2.0), 0.01)
    wanted = 100.0 * (10.0 ** (1.96 * 0.01 * np.sqrt(2.0)) - 1.0)
    assert known.describe(direction) == f"E · k^0.33 to ±{wanted:.2g} %"
    vague = Direction(np.array([1.0, 0.0]), 0.25)
    assert known.describe(vague) == f"E within a factor of {10.0 ** (1.96 * 0.25):.2g}"


def test_on_linear_scales_parts_of_the_ranges_are_told() -> None:
    free = (constant("x", log=False), constant("y", log=False))
    known = Identifiability(free, np.full(2, 0.5), np.eye(2), np.ones(2), np.ones(2), ())
    direction = Direction(np.array([0.6, -0.8]), 0.1)
    assert known.describe(direction) == "−0.80 y +0.60 x to ±20 % of their ranges"


def test_intervals_end_at_the_range() -> None:
    problem = Linear([[3.0]], [0.9], low=0.0, high=10.0, log=False)
    minimum = Minimum(np.array([0.9]), np.zeros(1))
    known = local_identifiability(problem, minimum)
    found = profile_likelihood(problem, minimum, 0, known.deviation[0])
    low, high = found.interval()
    assert high == 1.0
    assert low == pytest.approx(0.9 - 1.96 / 3.0, abs=0.05)


def test_the_search_goes_on_from_different_good_places() -> None:
    problem = Linear([[10.0, 0.0], [0.0, 1.0]], [0.3, 0.8])
    told = []
    starts = screen(problem, 512, 6, seed=3, report=lambda done, best: told.append((done, best)))
    assert starts.shape == (6, 2)
    values = problem.misfit(starts, (0,))
    assert np.all(np.diff(values) >= 0.0)
    for i, first in enumerate(starts):
        for second in starts[:i]:
            assert np.max(np.abs(first - second)) > 0.05
    assert told[-1][0] == 512 and told[-1][1] == pytest.approx(values[0])
    # Dropping hopeless points early loses none of the good ones.
    points = problem.misfit(screen(problem, 512, 1, seed=3, report=lambda *_: None), (0,))
    assert points[0] == values[0]


def test_no_place_at_all_is_said_so() -> None:
    problem = Linear([[1.0]], [0.5])
    problem.misfit = lambda u, runs, worst=np.inf: np.full(len(u), np.inf)
    with pytest.raises(InputError, match="none of 8 points"):
        screen(problem, 8, 2, seed=0, report=lambda *_: None)


def test_minima_at_one_place_are_one() -> None:
    def minimum(u: float, misfit: float) -> Minimum:
        return Minimum(np.array([u]), np.array([np.sqrt(misfit)]))

    found = distinct(
        [minimum(0.51, 2.0), minimum(0.2, 3.0), minimum(0.5, 1.0), minimum(0.505, 4.0)]
    )
    assert [(m.u[0], m.hits) for m in found] == [(0.5, 3), (0.2, 1)]
