"""Every method on functions with known minima, including rough and failing ones."""

from __future__ import annotations

import ast
import hashlib
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flexor import optimizers
from flexor.errors import InputError
from flexor.optimizers import Budget, Progress, SearchResult

METHODS = [name for name in optimizers.names() if name not in ("grid", "pareto")]
# Enough for every method to converge; less for the slowest one.
BUDGET = {"surrogate": Budget(evaluations=60)}


class Bowl:
    """The norm of a vector, with minimum 1 at `place`; optionally fails for x_0 > `fails`."""

    def __init__(self, k: int, fails: float | None = None) -> None:
        self.place = np.linspace(0.3, -0.7, k)
        self.fails = fails
        self.asked: list[np.ndarray] = []

    def residuals(self, x: np.ndarray) -> np.ndarray:
        distance = (x - self.place) * np.sqrt(np.linspace(1.0, 5.0, len(self.place)))
        vectors = np.concatenate((distance, np.ones((len(x), 1))), axis=1)
        if self.fails is not None:
            vectors[x[:, 0] > self.fails] = np.nan
        return vectors

    def __call__(self, x: np.ndarray) -> np.ndarray:
        self.asked.append(x)
        values = np.linalg.norm(self.residuals(x), axis=1)
        return np.where(np.isnan(values), np.inf, values)


def box(k: int) -> tuple[np.ndarray, np.ndarray]:
    return np.full(k, -2.0), np.linspace(1.0, 2.0, k)


def minimum(name: str, function: Bowl, seed: int = 3, **more: object) -> SearchResult:
    budget = more.pop("budget", BUDGET.get(name, Budget(evaluations=2000)))
    lower, upper = box(len(function.place))
    made = optimizers.method(name)
    return made.minimize(function, lower, upper, seed=seed, budget=budget, **more)  # type: ignore[arg-type]


def need(name: str) -> None:
    if name not in optimizers.available():
        pytest.skip(f"the library of {name} is not installed")


@pytest.fixture(params=METHODS)
def name(request: pytest.FixtureRequest) -> str:
    need(request.param)
    return str(request.param)


@pytest.mark.parametrize("k", [1, 2, 4])
def test_a_smooth_bowl_is_minimised(name: str, k: int) -> None:
    found = minimum(name, Bowl(k))
    assert found.value == pytest.approx(1.0, abs=1e-3)
    # The value is flat at its minimum: sqrt(2 * 1e-3) away it has risen by no more than that.
    np.testing.assert_allclose(found.design, Bowl(k).place, atol=0.05)
    assert found.value == Bowl(k)(found.design[None])[0]


def test_an_optimum_on_the_bounds_is_found_without_leaving_them(name: str) -> None:
    function = Bowl(2)
    function.place = np.array([3.0, -9.0])
    found = minimum(name, function)
    lower, upper = box(2)
    corner = np.array([upper[0], lower[1]])
    tolerance = 1e-2 if name in ("direct", "genetic-algorithm", "surrogate") else 1e-4
    np.testing.assert_allclose(found.design, corner, atol=tolerance)
    designs = np.concatenate(function.asked)
    assert np.all((designs >= lower) & (designs <= upper))


def request_hash(name: str) -> str:
    """Return a hash of all designs that a method requests."""
    function = Bowl(11 if name == "cma-es" else 3)
    minimum(name, function, budget=Budget(evaluations=40 if name == "surrogate" else 300))
    return hashlib.sha256(np.concatenate(function.asked).tobytes()).hexdigest()


def test_same_seed_same_search_in_this_process_and_in_another() -> None:
    names = [name for name in METHODS if name in optimizers.available()]
    np.random.seed(1)
    first = {name: request_hash(name) for name in names}
    np.random.seed(2)  # a method must not depend on numpy's global state
    again = {name: request_hash(name) for name in reversed(names)}
    assert again == first
    program = (
        "import importlib.util as u\n"
        f"spec = u.spec_from_file_location('here', {str(Path(__file__))!r})\n"
        "here = u.module_from_spec(spec)\n"
        "spec.loader.exec_module(here)\n"
        f"print({{name: here.request_hash(name) for name in {names!r}}})\n"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    ran = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, env=environment
    )
    assert ast.literal_eval(ran.stdout.splitlines()[-1]) == first


def test_another_seed_is_another_search(name: str) -> None:
    one, two = Bowl(2), Bowl(2)
    few = Budget(evaluations=20)
    minimum(name, one, seed=3, budget=few)
    minimum(name, two, seed=4, budget=few)
    assert np.concatenate(one.asked).tobytes() != np.concatenate(two.asked).tobytes()


@pytest.mark.parametrize("limit", [1, 7, 30])
def test_the_budget_is_exact_and_no_design_is_evaluated_twice(name: str, limit: int) -> None:
    function, reports = Bowl(3), list[Progress]()
    found = minimum(name, function, budget=Budget(evaluations=limit), progress=reports.append)
    designs = np.concatenate(function.asked)
    assert len(designs) == len(np.unique(designs, axis=0)) == found.evaluations <= limit
    if name != "levenberg-marquardt":  # may converge earlier
        assert found.evaluations == limit
        assert found.reason == f"the budget of {limit} evaluations is spent"
    assert (reports[-1].evaluations, reports[-1].value) == (found.evaluations, found.value)
    assert np.all(np.diff(found.improvement_values) < 0)
    assert found.improvement_values[-1] == found.value


def test_the_first_design_is_bitwise_the_start(name: str) -> None:
    function = Bowl(3)
    start = np.array([0.1, 0.2, 1.0 / 3.0])
    lower, upper = box(3)
    optimizers.method(name).minimize(
        function, lower, upper, start=start, budget=Budget(evaluations=30)
    )
    assert function.asked[0][0].tolist() == start.tolist()
    with pytest.raises(InputError, match="is outside the bounds"):
        optimizers.method(name).minimize(function, lower, upper, start=start + 9.0)


def test_failing_designs_are_avoided(name: str) -> None:
    # Half of the box fails; the optimum lies well outside it.
    lower, upper = box(2)
    function = Bowl(2, fails=0.6)
    search_ = optimizers.method(name)
    found = search_.minimize(
        function, lower, upper, [-1.0, 1.0], 1, BUDGET.get(name, Budget(evaluations=1500))
    )
    assert np.isinf(np.concatenate([function(x) for x in function.asked[:]])).any() or (
        name in ("levenberg-marquardt", "mads")
    )
    assert found.value == pytest.approx(1.0, abs=1e-2)


@pytest.mark.parametrize("failing", [np.inf, np.nan])
def test_a_search_in_which_every_design_fails_ends(name: str, failing: float) -> None:
    function = Bowl(2, fails=-9.0)
    lower, upper = box(2)

    class AlwaysFailing(Bowl):
        def __call__(self, x: np.ndarray) -> np.ndarray:
            return np.full(len(x), failing)

    with np.errstate(all="raise", under="ignore"):
        found = optimizers.method(name).minimize(
            AlwaysFailing(2, fails=-9.0), lower, upper, [0.1, 0.2], 1, Budget(evaluations=100)
        )
    assert found.value == np.inf
    assert found.design.tolist() == [0.1, 0.2]
    assert len(found.improvement_values) == 0
    assert function.asked == []


def test_a_search_on_a_plateau_ends(name: str) -> None:
    lower, upper = box(2)

    class Plateau(Bowl):
        def residuals(self, x: np.ndarray) -> np.ndarray:
            return np.ones((len(x), 3))

    found = optimizers.method(name).minimize(
        Plateau(2), lower, upper, [0.1, 0.2], 1, Budget(evaluations=60)
    )
    assert found.value == pytest.approx(np.sqrt(3.0))
    assert found.design.tolist() == [0.1, 0.2]


def test_a_search_without_a_budget_ends_by_itself(name: str) -> None:
    function = Bowl(1)
    options = {"surrogate": {"evaluations": 20}, "dual-annealing": {"iterations": 50}}
    made = optimizers.method(name, **options.get(name, {}))
    found = made.minimize(function, *box(1), seed=0)
    assert found.reason
    assert "budget" not in found.reason
    assert found.value == pytest.approx(1.0, abs=1e-3)


def test_an_exception_from_the_progress_callback_propagates(name: str) -> None:
    reports: list[Progress] = []

    def stop(at: Progress) -> None:
        reports.append(at)
        if at.evaluations > 5:
            raise KeyboardInterrupt

    lower, upper = box(4)
    with pytest.raises(KeyboardInterrupt):
        optimizers.method(name).minimize(Bowl(4), lower, upper, seed=1, progress=stop)
    assert np.all(np.diff([at.iteration for at in reports]) >= 0)
    assert all(at.detail for at in reports)


def test_an_exception_from_the_function_propagates(name: str) -> None:
    class Broken(Bowl):
        def __call__(self, x: np.ndarray) -> np.ndarray:
            if len(self.asked) == 2:
                raise ZeroDivisionError("mine")
            return super().__call__(x)

    lower, upper = box(2)
    with pytest.raises(ZeroDivisionError, match="mine"):
        optimizers.method(name).minimize(Broken(2), lower, upper, seed=1)


def test_global_methods_escape_a_local_minimum(name: str) -> None:
    if name in ("pattern-search", "pattern-search+polish", "levenberg-marquardt", "mads"):
        pytest.skip("a local method")

    def two_wells(x: np.ndarray) -> np.ndarray:
        shallow = ((x - 0.8) ** 2).sum(axis=1)
        deep = 2.0 * ((x + 1.2) ** 2).sum(axis=1) - 1.0
        return np.minimum(shallow, deep)

    found = optimizers.method(name).minimize(
        two_wells, np.full(2, -2.0), np.full(2, 1.0), [0.8, 0.8], 5, BUDGET.get(name, Budget(2000))
    )
    assert found.value == pytest.approx(-1.0, abs=1e-2)


def test_a_time_budget_stops_the_search(name: str) -> None:
    if name == "surrogate":
        pytest.skip("a single iteration may take that long")
    lower, upper = box(11)
    options = {"starts": 500} if name in ("pattern-search", "levenberg-marquardt") else {}
    found = optimizers.method(name, **options).minimize(
        Bowl(11), lower, upper, seed=1, budget=Budget(seconds=0.01)
    )
    assert found.reason == "the budget of 0.01 s is spent"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: optimizers.method("genetic-algoritm"), 'did you mean "genetic-algorithm"?'),
        (lambda: optimizers.method("cma-es", popsize=3), 'unknown option of cma-es "popsize"'),
        (lambda: optimizers.method("cma-es", population=2), "at least 4, or 0"),
        (lambda: optimizers.method("ga", population=1), "population of genetic-algorithm"),
        (
            lambda: optimizers.method("de", crossover=1.5),
            "is 1.5: it must be above 0 and at most 1",
        ),
        (
            lambda: optimizers.method("pso", patience=0),
            "patience of particle-swarm is 0: it must be from 1",
        ),
        (lambda: optimizers.method("direct", local=2), "must be 1 (yes) or 0 (no), got 2"),
        (lambda: optimizers.method("direct", side=0), "between 0 and 1"),
        (lambda: optimizers.method("annealing", iterations=0.5), "must be an integer"),
        (lambda: optimizers.method("lm", difference=0), "above 0 and at most 0.1"),
        (lambda: optimizers.method("grid", columns=3), "columns of grid must be a list"),
        (lambda: optimizers.method("grid", points=1), "from 2 to"),
        (
            lambda: optimizers.method("grid").minimize(Bowl(11), *box(11)),
            "a grid of 81 points along 11 parameters",
        ),
        (
            lambda: optimizers.method("lm").minimize(lambda x: x[:, 0], *box(1)),
            "least squares needs one that is the norm of a vector",
        ),
    ],
)
def test_invalid_input_is_rejected_with_one_sentence(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as error:
        call()
    assert message in str(error.value)
    assert str(error.value).endswith(".")


@pytest.mark.parametrize("missing", ["mads", "surrogate"])
def test_a_missing_library_is_named_with_its_install_command(
    missing: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("flexor.optimizers.extras.find_spec", lambda module: None)
    with pytest.raises(
        InputError, match=r"is not installed: .*pip install .*\b(PyNomadBBO|egobox)\.$"
    ):
        optimizers.method(missing)
    assert missing not in optimizers.available()
    assert missing in optimizers.names()


def test_a_long_invalid_option_value_is_truncated_in_the_message() -> None:
    with pytest.raises(InputError, match=r"option starts of .* must be an integer") as error:
        optimizers.method("bfgs", starts=[0] * 1000)
    assert len(str(error.value)) < 200


@pytest.mark.parametrize("value", [float("inf"), float("nan"), 2.5, "3", None])
def test_a_non_integer_option_is_rejected(value: Any) -> None:
    with pytest.raises(InputError, match=r"option starts of .* must be an integer"):
        optimizers.method("pattern-search", starts=value)


def test_aliases_and_spellings() -> None:
    assert optimizers.method("DE") == optimizers.method("differential_evolution")
    assert optimizers.canonical("Least squares") == "levenberg-marquardt"
    assert optimizers.method("ps", starts=2).name == "pattern-search"


def test_a_grid_is_evaluated_in_order_with_other_parameters_at_the_start() -> None:
    function = Bowl(3)
    lower, upper = box(3)
    start = np.array([0.1, 1.0 / 3.0, 0.7])
    found = optimizers.Grid(points=20, columns=(2, 0)).minimize(function, lower, upper, start)
    designs = np.concatenate(function.asked).reshape(20, 20, 3)
    assert found.evaluations == 400
    assert np.all(designs[..., 1] == 1.0 / 3.0)
    np.testing.assert_allclose(designs[:, 5, 2], np.linspace(lower[2], upper[2], 20))
    np.testing.assert_allclose(designs[7, :, 0], np.linspace(lower[0], upper[0], 20))
    assert designs[-1, -1, 0] == upper[0]


def test_a_small_budget_of_auto_is_not_spent_on_its_sample() -> None:
    function = Bowl(3)
    found = minimum("auto", function, budget=Budget(evaluations=60))
    assert found.value == pytest.approx(1.0, abs=1e-6)


class Ripples:
    """A quadratic function with minimum 0 at `place`, and so many wells that few recur."""

    def __init__(self, k: int) -> None:
        self.place = np.linspace(0.3, -0.7, k)
        self.asked: list[np.ndarray] = []

    def __call__(self, x: np.ndarray) -> np.ndarray:
        self.asked.append(x)
        away = x - self.place
        return np.asarray((away**2 + 0.2 * (1.0 - np.cos(12.0 * away))).sum(axis=1))


@pytest.mark.parametrize("seed", [0, 1])
def test_auto_goes_across_wells_where_sqp_ends_in_different_ones(seed: int) -> None:
    lower, upper = box(6)
    whole, part = Ripples(6), Ripples(6)
    auto = optimizers.method("auto")
    found = auto.minimize(whole, lower, upper, seed=seed, budget=Budget(evaluations=2000))
    # The next well is 2π/12 away along one axis, at a height of 0.256.
    assert found.value < 0.25
    assert np.abs(found.design - whole.place).max() < np.pi / 12.0
    # A smaller budget cuts the search short and changes nothing before: it can be resumed.
    auto.minimize(part, lower, upper, seed=seed, budget=Budget(evaluations=1500))
    begun = np.concatenate(part.asked)
    assert len(begun) > 1400
    np.testing.assert_array_equal(begun, np.concatenate(whole.asked)[: len(begun)])
