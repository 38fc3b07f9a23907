"""Fronts of problems whose front is known."""

from __future__ import annotations

import numpy as np
import pytest
from pymoo.indicators.hv import HV

from flexor.errors import InputError
from flexor.optimizers import Budget, Pareto, PatternSearch, nondominated

Array = np.ndarray


class Recording:
    """A function of several objectives with constraints that keeps what it was asked."""

    def __init__(self) -> None:
        self.values: list[Array] = []
        self.asked = 0

    def __call__(self, designs: Array) -> Array:
        self.asked += len(designs)
        values, excesses = self.objectives(designs)
        self.values += list(values[~(excesses > 0.0).any(axis=1)])
        return values[:, 0]

    def front(self) -> Array:
        found = np.array(self.values)
        return found[nondominated(found)]

    def objectives(self, designs: Array) -> tuple[Array, Array]:
        raise NotImplementedError


class BinhKorn(Recording):
    """Binh and Korn (1997). The front: x = y in [0, 3], then y = 3 and x in [3, 5]."""

    lower, upper = np.zeros(2), np.array([5.0, 3.0])
    reference, ideal = np.array([140.0, 50.0]), np.array([0.0, 4.0])

    def objectives(self, designs: Array) -> tuple[Array, Array]:
        x, y = designs.T
        values = np.stack((4.0 * (x**2 + y**2), (x - 5.0) ** 2 + (y - 5.0) ** 2), axis=1)
        first, second = (x - 5.0) ** 2 + y**2 - 25.0, 7.7 - (x - 8.0) ** 2 - (y + 3.0) ** 2
        return values, np.stack((first / 25.0, second / 7.7), axis=1)

    def truth(self) -> Array:
        x = np.linspace(0.0, 5.0, 20001)
        return self.objectives(np.stack((x, np.minimum(x, 3.0)), axis=1))[0]


class Constr(Recording):
    """Deb (2001). A constraint is active on one half of the front, a bound on the other."""

    lower, upper = np.array([0.1, 0.0]), np.array([1.0, 5.0])
    reference, ideal = np.array([1.0, 9.0]), np.array([0.39, 1.0])

    def objectives(self, designs: Array) -> tuple[Array, Array]:
        x, y = designs.T
        values = np.stack((x, (1.0 + y) / x), axis=1)
        return values, np.stack((6.0 - 9.0 * x - y, 1.0 - 9.0 * x + y), axis=1)

    def truth(self) -> Array:
        x = np.linspace(7.0 / 18.0, 1.0, 20001)
        return self.objectives(np.stack((x, np.maximum(6.0 - 9.0 * x, 0.0)), axis=1))[0]


def hypervolume(front: Array, problem: Recording) -> float:
    reference, ideal = problem.reference, problem.ideal  # type: ignore[attr-defined]
    return float(HV(ref_point=np.zeros(2))((front - reference) / (reference - ideal)))


@pytest.mark.parametrize("kind", [BinhKorn, Constr])
def test_hypervolume_is_that_of_the_known_front(kind: type) -> None:
    """Within a percent, from which NSGA-II with as many designs is farther away."""
    problem = kind()
    result = Pareto().minimize(
        problem, kind.lower, kind.upper, seed=1, budget=Budget(evaluations=1500)
    )
    assert result.evaluations <= 1500
    exact = hypervolume(problem.truth(), problem)
    assert 0.99 * exact < hypervolume(problem.front(), problem) <= exact * (1.0 + 1e-9)
    plain = kind()
    alone = Pareto(descents=0, generations=100)
    alone.minimize(plain, kind.lower, kind.upper, seed=1, budget=Budget(evaluations=1500))
    assert hypervolume(plain.front(), plain) < hypervolume(problem.front(), problem)


@pytest.mark.parametrize("kind", [BinhKorn, Constr])
def test_refined_points_are_on_the_front(kind: type) -> None:
    """The search by gradients goes to the front itself: no known point is better in both."""
    problem = kind()
    Pareto(generations=5).minimize(problem, kind.lower, kind.upper, seed=0)
    truth, found = problem.truth(), problem.front()
    scale = np.ptp(truth, axis=0)
    short = [np.min(np.max((point - truth) / scale, axis=1)) for point in found]
    # Most are exact; those of the population and of differences are not.
    assert np.quantile(short, 0.5) < 1e-4


def test_the_same_seed_gives_the_same_designs() -> None:
    """To the last bit, and another seed others."""
    runs = []
    for seed in (3, 3, 4):
        problem = BinhKorn()
        Pareto(generations=3, descents=4).minimize(
            problem, BinhKorn.lower, BinhKorn.upper, seed=seed
        )
        runs.append(np.array(problem.values).tobytes())
    assert runs[0] == runs[1] != runs[2]


def test_nondominated_rows_are_those_found_one_by_one() -> None:
    """Of random values with ties."""
    values = np.random.default_rng(0).integers(0, 6, (60, 3)).astype(float)
    wanted = {
        tuple(row)
        for row in values.tolist()
        if not any(np.all(o <= row) and np.any(o < row) for o in values)
    }
    found = values[nondominated(values)]
    assert {tuple(row) for row in found.tolist()} == wanted
    assert len(found) == len(wanted)
    assert np.all(np.diff(found[:, 0]) >= 0.0)


def test_one_objective_is_refused() -> None:
    """In one sentence."""

    def one(designs: Array) -> Array:
        return designs[:, 0]

    with pytest.raises(InputError, match="one objective: this method needs several"):
        Pareto().minimize(one, np.zeros(2), np.ones(2))
    PatternSearch().minimize(one, np.zeros(2), np.ones(2))
