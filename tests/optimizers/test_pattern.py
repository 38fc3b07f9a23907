"""Pattern search on functions with known minima, including rough and failing ones."""

from __future__ import annotations

import numpy as np
import pytest

from flexor.errors import InputError
from flexor.optimizers import Budget, PatternSearch, Progress, SearchResult, method

LOWER, UPPER = np.array([-2.0, -2.0]), np.array([2.0, 2.0])


def quadratic(x: np.ndarray) -> np.ndarray:
    d = x - np.array([0.3, -0.7])
    return d[:, 0] ** 2 + 3.0 * d[:, 1] ** 2 + d[:, 0] * d[:, 1]


def rosenbrock(x: np.ndarray) -> np.ndarray:
    return 100.0 * (x[:, 1] - x[:, 0] ** 2) ** 2 + (1.0 - x[:, 0]) ** 2


def same(one: SearchResult, other: SearchResult) -> bool:
    return all(
        np.asarray(getattr(one, field)).tobytes() == np.asarray(getattr(other, field)).tobytes()
        for field in one.__dataclass_fields__
        if field != "reason"
    )


def test_quadratic_is_minimised_to_the_mesh_tolerance() -> None:
    found = PatternSearch().minimize(quadratic, LOWER, UPPER, start=[1.9, 1.9])
    np.testing.assert_allclose(found.design, [0.3, -0.7], atol=1e-5)
    assert found.value == quadratic(found.design[None])[0]
    assert found.reason == "the mesh is below 1e-06"
    assert np.all(np.diff(found.improvement_values) < 0)
    assert np.all(np.diff(found.improvement_evaluations) > 0)
    np.testing.assert_array_equal(quadratic(found.improvement_designs), found.improvement_values)


def test_rosenbrock_within_bounds() -> None:
    found = PatternSearch(tolerance=1e-9).minimize(rosenbrock, LOWER, UPPER, start=[-1.2, 1.0])
    np.testing.assert_allclose(found.design, [1.0, 1.0], atol=1e-3)
    # With x <= 0.5 the minimum lies on the bound, at (0.5, 0.25).
    bound = PatternSearch().minimize(rosenbrock, LOWER, np.array([0.5, 2.0]), start=[-1.2, 1.0])
    assert bound.design[0] == pytest.approx(0.5, abs=1e-2)


def test_an_optimum_on_a_bound_is_reached_exactly() -> None:
    lower, upper = np.array([0.06, 0.004]), np.array([0.14, 0.012])
    found = PatternSearch().minimize(lambda x: x[:, 0] - x[:, 1], lower, upper, [0.1, 0.0077])
    assert found.design.tolist() == [0.06, 0.012]


def test_no_design_outside_the_bounds_or_evaluated_twice() -> None:
    asked: list[np.ndarray] = []

    def watch(x: np.ndarray) -> np.ndarray:
        asked.append(x)
        return rosenbrock(x)

    found = PatternSearch(starts=3).minimize(watch, LOWER, UPPER, [1.9, -1.9], seed=4)
    designs = np.concatenate(asked)
    assert np.all((designs >= LOWER) & (designs <= UPPER))
    assert len(np.unique(designs, axis=0)) == len(designs) == found.evaluations


def test_a_poll_is_one_batch_of_the_positive_basis() -> None:
    sizes: list[int] = []

    def watch(x: np.ndarray) -> np.ndarray:
        sizes.append(len(x))
        return np.full(len(x), 1.0)

    five = np.zeros(5)
    search = PatternSearch(tolerance=0.1)
    search.minimize(watch, five, five + 1, start=five + 0.5)
    assert sizes == [1, 10, 10]  # mesh 1/4, 1/8, then below 0.1
    sizes.clear()
    PatternSearch(starts=4, tolerance=0.1).minimize(watch, five, five + 1, start=five + 0.5)
    assert sizes[0] == 4
    assert sizes[1] > 30


def test_the_mesh_doubles_on_success_and_halves_on_failure() -> None:
    meshes: list[float] = []
    search = PatternSearch(initial_mesh=0.125, largest_mesh=0.5)
    values = iter([3.0, 2.0, 1.0, 0.5, 0.5])  # each poll: three successes, then none
    polls = search.iterate(
        lambda x: np.full(len(x), next(values, 9.0)), LOWER, UPPER, start=[0.0, 0.0]
    )
    for _ in range(6):
        meshes.append(next(polls)[0].mesh)
    assert meshes == [0.125, 0.25, 0.5, 0.5, 0.25, 0.125]


def test_the_search_depends_on_the_seed_only() -> None:
    search, few = PatternSearch(starts=4), Budget(evaluations=1000)
    one = search.minimize(rosenbrock, LOWER, UPPER, seed=5, budget=few)
    two = search.minimize(rosenbrock, LOWER, UPPER, seed=5, budget=few)
    other = search.minimize(rosenbrock, LOWER, UPPER, seed=6, budget=few)
    assert same(one, two)
    assert not same(one, other)


def test_ties_between_neighbours_are_broken_by_the_seed() -> None:
    def ridge(x: np.ndarray) -> np.ndarray:
        return -np.abs(x).sum(axis=1)

    ends = {
        tuple(PatternSearch().minimize(ridge, LOWER, UPPER, [0.0, 0.0], seed).design)
        for seed in range(20)
    }
    assert len(ends) > 1
    assert all(abs(x) == 2.0 for end in ends for x in end)


def test_more_starts_escape_a_local_minimum() -> None:
    def two_wells(x: np.ndarray) -> np.ndarray:
        shallow = ((x - 1.5) ** 2).sum(axis=1)
        deep = 30 * ((x + 1.5) ** 2).sum(axis=1) - 1.0
        return np.minimum(shallow, deep)

    alone = PatternSearch(initial_mesh=0.05).minimize(two_wells, LOWER, UPPER, [1.0, 1.0])
    several = PatternSearch(starts=16, initial_mesh=0.05).minimize(
        two_wells, LOWER, UPPER, [1.0, 1.0]
    )
    assert alone.value == pytest.approx(0.0, abs=1e-8)
    assert several.value == pytest.approx(-1.0, abs=1e-8)
    np.testing.assert_array_equal(several.improvement_designs[0], [1.0, 1.0])


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_failing_designs_are_avoided(bad: float) -> None:
    def holes(x: np.ndarray) -> np.ndarray:
        cells = np.floor(x * 7.3).astype(int).sum(axis=1)
        return np.where(cells % 5 == 2, bad, quadratic(x))

    found = PatternSearch(starts=4).minimize(holes, LOWER, UPPER, start=[1.9, 1.9])
    assert np.isfinite(found.value)
    assert found.value < 0.05


def test_a_search_on_a_plateau_or_with_only_failures_ends_at_the_mesh_tolerance() -> None:
    flat = PatternSearch().minimize(lambda x: np.zeros(len(x)), LOWER, UPPER, [0.1, 0.2])
    assert flat.design.tolist() == [0.1, 0.2]
    assert flat.reason == "the mesh is below 1e-06"
    failed = PatternSearch().minimize(lambda x: np.full(len(x), np.nan), LOWER, UPPER, [0.1, 0.2])
    assert failed.value == np.inf
    assert failed.design.tolist() == [0.1, 0.2]
    assert len(failed.improvement_values) == 0


def test_the_search_recovers_from_a_failing_start() -> None:
    def corner(x: np.ndarray) -> np.ndarray:
        return np.where(x[:, 0] > 0.5, np.inf, quadratic(x))

    found = PatternSearch().minimize(corner, LOWER, UPPER, start=[1.4, 0.0])
    assert found.value < 0.02


def test_the_evaluation_budget_is_exact() -> None:
    for limit in (1, 7, 30):
        calls = []

        def counting(x: np.ndarray, calls: list[int] = calls) -> np.ndarray:
            calls.append(len(x))
            return rosenbrock(x)

        reports: list[Progress] = []
        found = PatternSearch().minimize(
            counting, LOWER, UPPER, [-1.2, 1.0], 0, Budget(evaluations=limit), reports.append
        )
        assert (reports[-1].evaluations, reports[-1].remaining) == (limit, 0)
        assert reports[-1].value == found.value
        assert sum(calls) == found.evaluations == limit
        assert found.reason == f"the budget of {limit} evaluations is spent"


def test_a_time_budget_stops_the_search() -> None:
    found = PatternSearch(tolerance=1e-300).minimize(
        rosenbrock, LOWER, UPPER, [-1.2, 1.0], budget=Budget(seconds=0.05)
    )
    assert found.reason == "the budget of 0.05 s is spent"


def test_progress_is_reported_and_may_stop_the_search() -> None:
    reports: list[Progress] = []

    def progress(at: Progress) -> None:
        reports.append(at)
        if at.iteration == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        PatternSearch().minimize(quadratic, LOWER, UPPER, [1.9, 1.9], progress=progress)
    assert [at.iteration for at in reports] == list(range(6))
    assert reports[0].evaluations == 1
    assert reports[0].design.tolist() == [1.9, 1.9]
    assert np.all(np.diff([at.value for at in reports]) <= 0)
    assert reports[1].detail.startswith("mesh ")


def test_remaining_evaluations_on_a_plateau_are_predicted() -> None:
    reports: list[Progress] = []
    done = PatternSearch(starts=2).minimize(
        lambda x: np.zeros(len(x)), LOWER, UPPER, [[0.1, 0.2], [0.7, -0.3]], progress=reports.append
    )
    predicted = [at.evaluations + (at.remaining or 0) for at in reports]
    assert predicted == [done.evaluations] * len(reports)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: method("patern-search"), 'did you mean "pattern-search"?'),
        (lambda: method("pattern-search", start=3), 'did you mean "starts"?'),
        (
            lambda: method("pattern-search", starts=0),
            "option starts of pattern-search is 0: it must be from 1",
        ),
        (lambda: method("pattern-search", starts=1.5), "must be an integer, got 1.5"),
        (lambda: method("pattern-search", tolerance="x"), "must be a number, got 'x'"),
        (lambda: method("pattern-search", initial_mesh=float("nan")), "above 0 and at most 1"),
        (lambda: Budget(evaluations=0), "budget is 0: it must be at least 1"),
        (lambda: Budget(seconds=float("nan")), "must be greater than zero"),
        (
            lambda: PatternSearch().minimize(quadratic, LOWER, UPPER, [3.0, 0.0]),
            "the start [3.0, 0.0] is outside the bounds",
        ),
        (lambda: PatternSearch().minimize(quadratic, LOWER, UPPER, [0.0]), "a start has 2 numbers"),
    ],
)
def test_invalid_input_is_rejected_with_one_sentence(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as error:
        call()
    assert message in str(error.value)


def test_methods_are_constructed_by_name_with_options() -> None:
    assert method("Pattern_Search", starts=8.0, tolerance=1e-4) == PatternSearch(
        starts=8, tolerance=1e-4
    )
