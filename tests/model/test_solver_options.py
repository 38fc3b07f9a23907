"""Settings of the solver are refused in one sentence, or used."""

from __future__ import annotations

import pytest

import flexor
from flexor.errors import InputError


@pytest.mark.parametrize(
    ("option", "sentence"),
    [
        (
            {"tolerence": 1e-9},
            'unknown solver option "tolerence" (did you mean "tolerance"?): expected one of '
            '"tolerance", "max_iterations", "min_step".',
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
            "solver option max_iterations is -1: a whole number from 1 is needed.",
        ),
        (
            {"max_iterations": 2.5},
            "solver option max_iterations is 2.5: a whole number from 1 is needed.",
        ),
        (
            {"max_iterations": float("inf")},
            "solver option max_iterations is inf: a whole number from 1 is needed.",
        ),
        ({"max_iterations": True}, "solver option max_iterations is true: expected a number."),
    ],
)
def test_one_sentence(option: dict[str, float], sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        flexor.load("finger").equilibrium([0, 1], **option)
    assert str(caught.value) == sentence


def test_too_few_iterations_are_told_not_raised() -> None:
    path = flexor.load("finger").equilibrium([0, 5, 6], max_iterations=2.0)
    assert list(path.status) == ["converged", "iteration-limit", "not-reached"]
    assert not path.converged[-1]


@pytest.mark.parametrize("tolerance", [1e-12, 0.2, 1.0])
def test_every_tolerance_that_is_allowed_works_in_long_steps(tolerance: float) -> None:
    path = flexor.load("finger").equilibrium([0, 20], tolerance=tolerance)
    assert path.converged.all()
