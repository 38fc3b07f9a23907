"""Gradients of studies: as functions for optimisers, in searches, in records, at the optimum."""

from __future__ import annotations

import doctest
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from scipy.optimize import check_grad, minimize

import flexor
from flexor import optimizers
from flexor.errors import InputError
from flexor.objectives import custom
from flexor.study import Problem, Record, RecordedEvaluator, Threads, function, optimize, resume

METHODS = ("levenberg-marquardt", "multistart-bfgs", "pattern-search+polish")


def test_the_function_is_what_scipy_takes_with_jac(analytic: ModuleType) -> None:
    made = flexor.objective_function(analytic.AnalyticModel(), "L+R01", "f_b")
    inside = np.array([0.1, 0.007, 0.0075])
    error = check_grad(lambda p: made(p)[0], lambda p: made(p)[1], inside, epsilon=1e-8)
    assert error < 1e-3 * np.linalg.norm(made(inside)[1])
    found = minimize(made, inside, jac=True, bounds=made.bounds)
    assert found.fun < made(inside)[0]


def test_a_failed_design_has_a_finite_value_and_says_why(analytic: ModuleType) -> None:
    made = flexor.objective_function(analytic.AnalyticModel(), "R01", "f_b", failed=77.0)
    value, gradient = made([0.007, 0.0042])
    assert (value, gradient.tolist()) == (77.0, [0.0, 0.0])
    slopes = made.evaluate([[0.007, 0.0042], [0.007, 0.008]])
    assert slopes.meaningful.tolist() == [False, True]
    assert np.isnan(slopes.gradient[0]).all()
    assert slopes.regularity[0] == "no-equilibrium"
    assert "did not converge" in slopes.reason[0]


def test_a_gradient_after_a_snap_says_so() -> None:
    made = flexor.objective_function(flexor.load("finger", "calibrated"), "R01")
    slopes = made.evaluate([[0.0116, 0.008], [0.005, 0.006]])
    batch = made.problem.model.evaluate(made.problem.geometry(np.array([[0.005, 0.006]])))
    assert batch.event_count[0] > 0
    assert slopes.regularity.tolist() == ["regular", "snapped"]
    assert slopes.meaningful.tolist() == [True, False]


def test_an_objective_without_a_gradient_is_refused_in_one_sentence(analytic: ModuleType) -> None:
    own = custom("mine", lambda path: float(path.joint_angles[-1, 0]))
    with pytest.raises(InputError, match=r'^objective "mine" has no gradient\.$'):
        flexor.objective_function(analytic.AnalyticModel(), "L", own)
    # Searches take differences instead.
    study = optimize(analytic.AnalyticModel(), "L", own, "bfgs", budget=40)
    assert study.record.derivatives(study.best.vector) is None


def test_the_example_of_the_docstring_runs() -> None:
    ran = doctest.testmod(function)
    assert ran.attempted > 3
    assert ran.failed == 0


@pytest.mark.parametrize("name", METHODS)
def test_exact_gradients_save_designs_and_are_recorded(analytic: ModuleType, name: str) -> None:
    # The three angles of this model are in proportion, so that least squares has one equation: for
    # more parameters its steps are not determined.
    sets, k = ("L", 1) if name == "levenberg-marquardt" else ("L+R01", 3)
    exact = optimize(analytic.AnalyticModel(), sets, "f_b", name)
    slopes = exact.record.derivatives(exact.best.vector)
    assert slopes is not None
    assert slopes[0].shape == (4, k)
    problem = exact.problem
    recorded = RecordedEvaluator(problem, Record(None, (k, 6, 3)), Threads(), gradients=False)
    chosen = problem.parameters
    differences = optimizers.method(name).minimize(
        recorded, chosen.lower, chosen.upper, chosen.start
    )
    assert exact.result is not None
    assert exact.result.value == pytest.approx(differences.value, rel=1e-6)
    assert exact.evaluations < 0.8 * differences.evaluations


@pytest.mark.parametrize("name", METHODS)
def test_a_study_of_the_finger_resumes_to_the_same_record(tmp_path: Path, name: str) -> None:
    given: dict[str, Any] = {"method": name, "seed": 1, "start": "random"}
    whole = optimize(flexor.load("finger", "calibrated"), "R01", "f_b", budget=40, **given)
    short = optimize(
        flexor.load("finger", "calibrated"), "R01", "f_b", budget=17, folder=tmp_path / "s", **given
    )
    short.close()
    longer = resume(tmp_path / "s", budget=40)
    assert longer.record.designs().tobytes() == whole.record.designs().tobytes()
    for design in whole.record.designs():
        one, two = whole.record.derivatives(design), longer.record.derivatives(design)
        assert one is not None
        assert two is not None
        assert (one[0].tobytes(), one[1]) == (two[0].tobytes(), two[1])


def test_designs_recorded_without_derivatives_are_differentiated_when_asked(
    analytic: ModuleType,
) -> None:
    model = analytic.AnalyticModel()
    plain = optimize(model, "L", "f_b", budget=10)
    designs = plain.record.designs()[:3]
    recorded = RecordedEvaluator(plain.problem, plain.record, Threads(), gradients=True)
    gradient = recorded.gradient(designs)
    outcomes = plain.problem.evaluate(designs, gradient=True)
    np.testing.assert_array_equal(gradient, plain.problem.gradients(outcomes))
    assert recorded.evaluated == 0
    assert plain.evaluations == 10


def test_sensitivity_is_the_slope_and_what_becomes_of_a_design_that_is_off() -> None:
    model = flexor.load("finger", "calibrated")
    study = optimize(model, "L+R01", "f_b", budget=1)
    found, step = study.best.sensitivity, 1e-7
    assert found.steps == ("1 mm", "1 mm", "1 mm")
    problem: Problem = replace(study.problem, options={"tolerance": 1e-12})
    for k in range(3):
        moved = study.best.vector + np.array([[-step], [step]]) * np.eye(3)[k]
        angles = problem.evaluate(moved).joint_angles[:, -1]
        slope = (angles[1] - angles[0]) / (2 * step)
        np.testing.assert_allclose(found.joint_angles[:, k], slope, rtol=1e-4, atol=1e-4)
        off = study.best.vector + np.array([[-1e-3], [1e-3]]) * np.eye(3)[k]
        bending = problem.evaluate(off).joint_angles[:, -1].sum(axis=1)
        np.testing.assert_allclose(found.off[k], bending, rtol=1e-6)
        assert found.tolerance[k] == pytest.approx(max(0.0, *(found.bending - bending)), abs=1e-6)
