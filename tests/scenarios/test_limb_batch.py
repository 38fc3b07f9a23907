"""Wearers as one batch of one model."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import flexor
from flexor.scenarios import Scenario
from flexor.study import Problem
from flexor.study.scenario_problem import ScenarioProblem, Uncertainty

BOUNDS = {"exosuit.length": ("9 cm", "11 cm"), "exosuit.section.wall": ("1.5 mm", "3 mm")}


@pytest.fixture(scope="module")
def nominal() -> Problem:
    model = flexor.load("pneumatic-finger")
    aim = "maximise range-of-motion"
    return Problem.of(model, BOUNDS, aim, subject_to=["overlap <= 1.5 mm"], force="0:60:20 kPa")


@pytest.mark.parametrize("tolerance", [{}, {"middle.to.at": 0.02, "exosuit.length": "0.5 mm"}])
def test_one_batch_has_the_results_of_each_model(nominal: Problem, tolerance) -> None:
    """Bit by bit: values, constraints and all derivatives."""
    stated = Uncertainty(tolerance=tolerance, samples=2 if tolerance else 0, wearers=4)
    batch, apart = (ScenarioProblem.over(nominal, stated, seed=3) for _ in range(2))
    assert batch._limb_batch is not None
    apart.__dict__["_limb_batch"] = None
    designs = np.array([[0.1, 2e-3], [0.093, 2.7e-3]])
    mine, theirs = (each.evaluate(designs, gradient=True) for each in (batch, apart))
    assert np.isfinite(theirs.value).all()
    for name in ("value", "violation", "constraint_values", "value_gradient"):
        np.testing.assert_array_equal(getattr(mine, name), getattr(theirs, name))
    np.testing.assert_array_equal(mine.constraint_gradients, theirs.constraint_gradients)


def test_another_process_finds_the_same_bits(nominal: Problem) -> None:
    """A pickled problem is that of a worker of a cluster."""
    problem = ScenarioProblem.over(nominal, Uncertainty(wearers=3))
    design = np.array([[0.0971, 2.31e-3]])
    here = problem.evaluate(design, gradient=True)
    there = pickle.loads(pickle.dumps(problem)).evaluate(design, gradient=True)
    for name in ("value", "constraint_values", "value_gradient", "constraint_gradients"):
        assert getattr(here, name).tobytes() == getattr(there, name).tobytes()


@pytest.mark.parametrize(
    "changes",
    [
        {"materials": {"silicone": {"strain_limit": 1.0}}},
        {"evaluation": {"pressure": "50 kPa", "pressure_step": "10 kPa"}},
        {"bodies": {"exosuit": {"elements": 40}}},
    ],
)
def test_other_differences_are_evaluated_one_by_one(changes) -> None:
    """What the engine does not have as a parameter."""
    model = flexor.load("pneumatic-finger")
    nominal = Problem.of(model, {"exosuit.length": BOUNDS["exosuit.length"]}, "maximise bending")
    people = [Scenario("plain"), Scenario("other", 1.0, changes)]
    assert ScenarioProblem.over(nominal, Uncertainty(people))._limb_batch is None
