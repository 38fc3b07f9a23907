"""Settings of the solver are refused in one sentence, or used."""

from __future__ import annotations

from pathlib import Path as FilePath

import numpy as np
import pytest

import flexor
from flexor import _engine
from flexor.errors import InputError


@pytest.mark.parametrize(
    ("option", "sentence"),
    [
        (
            {"tolerence": 1e-9},
            'unknown solver option "tolerence" (did you mean "tolerance"?): expected one of '
            '"tolerance", "max_iterations", "max_seconds", "min_step", "max_displacement", '
            '"max_displacement_with_contact", "max_displacement_with_springs".',
        ),
        ({"tolerance": 0.0}, "solver option tolerance is 0.0: it must be above 0 and at most 1."),
        (
            {"tolerance": float("nan")},
            "solver option tolerance is nan: it must be above 0 and at most 1.",
        ),
        ({"tolerance": "fine"}, 'solver option tolerance is "fine": expected a number.'),
        ({"min_step": -1}, "solver option min_step is -1: it must be above 0 and at most 1."),
        (
            {"max_iterations": -1},
            "solver option max_iterations is -1: expected an integer from 1.",
        ),
        (
            {"max_iterations": 2.5},
            "solver option max_iterations is 2.5: expected an integer from 1.",
        ),
        (
            {"max_iterations": float("inf")},
            "solver option max_iterations is inf: expected an integer from 1.",
        ),
        (
            {"max_displacement": 2e6},
            "solver option max_displacement is 2000000.0: it must be above 0 and at most 1e+06.",
        ),
        ({"max_seconds": 0}, "solver option max_seconds is 0: it must be above 0 and at most inf."),
        ({"max_iterations": True}, "solver option max_iterations is true: expected a number."),
    ],
)
def test_one_sentence(option: dict[str, float], sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        flexor.load("finger", "calibrated").equilibrium([0, 1], **option)
    assert str(caught.value) == sentence


def test_the_engine_says_what_its_options_are() -> None:
    assert list(_engine.SOLVER_OPTIONS) == [
        "tolerance",
        "max_iterations",
        "max_seconds",
        "min_step",
        "max_displacement",
        "max_displacement_with_contact",
        "max_displacement_with_springs",
    ]
    for option in _engine.SOLVER_OPTIONS.values():
        assert option["minimum"] <= option["default"] <= option["maximum"]
        assert option["doc"].endswith(".")


def test_every_option_is_in_the_docs() -> None:
    method = (FilePath(__file__).parents[2] / "docs" / "method.md").read_text(encoding="utf-8")
    for name, option in _engine.SOLVER_OPTIONS.items():
        (row,) = [line for line in method.splitlines() if line.startswith(f"| `{name}` |")]
        assert float(row.split("|")[2].replace(",", "")) == option["default"]


def test_the_engine_refuses_by_itself() -> None:
    engine = flexor.load("finger").engine
    nothing = np.zeros((1, 0))
    with pytest.raises(ValueError, match="min_step is 2: it must be above 0 and at most 1"):
        engine.path([], nothing, [[0.0]], min_step=2.0)
    with pytest.raises(ValueError, match="no solver option is named minimum_step"):
        engine.path([], nothing, [[0.0]], minimum_step=0.5)


def test_shorter_substeps_lead_to_the_same_equilibrium() -> None:
    model = flexor.load("finger", "printed")
    paths = [model.equilibrium([0, 5], max_displacement_with_contact=x) for x in (4.0, 0.5)]
    assert paths[0].iterations[-1] < paths[1].iterations[-1]
    assert np.allclose(paths[0].q, paths[1].q, atol=1e-8)


def test_too_few_iterations_are_told_not_raised() -> None:
    path = flexor.load("finger", "calibrated").equilibrium([0, 5, 6], max_iterations=2.0)
    assert list(path.status) == ["converged", "iteration-limit", "not-reached"]
    assert not path.converged[-1]


@pytest.mark.parametrize("tolerance", [1e-12, 0.2, 1.0])
def test_every_tolerance_that_is_allowed_works_in_long_steps(tolerance: float) -> None:
    path = flexor.load("finger", "calibrated").equilibrium([0, 20], tolerance=tolerance)
    assert path.converged.all()


def test_a_step_that_takes_too_long_is_told_not_raised() -> None:
    path = flexor.load("finger", "calibrated").equilibrium([0, 5, 6], max_seconds=1e-9)
    assert list(path.status) == ["time-limit", "not-reached", "not-reached"]
