"""Aggregates and samples, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from flexor.errors import InputError
from flexor.model.units import ANGLE
from flexor.scenarios import Tolerance, aggregate
from flexor.scenarios.tolerance import REACH, samples, within

VALUES = np.array([[-3.0, -1.0, -2.0], [5.0, 4.0, np.inf]])
WEIGHTS = np.array([1.0, 1.0, 2.0])
KEPT = np.zeros((2, 3))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("mean", -2.0),
        ("worst", -1.0),
        ("quantile 0.25", -3.0),
        ("quantile 0.75", -2.0),
        ("quantile 0.76", -1.0),
        ("quantile 1", -1.0),
    ],
)
def test_aggregates_of_three_scenarios(text: str, expected: float) -> None:
    made = aggregate(text)
    found = made.value(VALUES, WEIGHTS, KEPT)
    assert found[0] == expected and np.isinf(found[1])
    assert made.shares(VALUES, WEIGHTS)[0] @ VALUES[0] == expected


def test_the_share_that_is_served() -> None:
    """To be served is to reach the level and to keep the constraints; a failure is not served."""
    made = aggregate("served 2 rad", -1.0, ANGLE)
    assert made.level == -2.0
    found = made.value(VALUES, WEIGHTS, np.array([[0.0, 0.0, 0.1], [0.0, 0.0, 0.0]]))
    # A quarter; half of the weight is short by 0.1, a quarter by a half of the level.
    assert found[0] == pytest.approx(-0.25 + 1e-3 * (0.5 * 0.1 + 0.25 * 0.5))
    assert found[1] == pytest.approx(1e-3)


def test_samples_follow_their_distributions() -> None:
    made = (Tolerance("a", "uniform", 0.2, ""), Tolerance("b", "normal", 3.0, ""))
    found = samples(made, 1024, 7)
    assert np.array_equal(found, samples(made, 1024, 7))
    assert not np.array_equal(found, samples(made, 1024, 8))
    assert np.abs(found[:, 0]).max() <= 0.2
    assert found[:, 0].std() == pytest.approx(0.2 / np.sqrt(3.0), rel=0.01)
    assert found[:, 1].std() == pytest.approx(3.0, rel=0.01)
    assert np.abs(found.mean(axis=0)).max() < 0.01
    assert np.abs(within(made, 256, 0)[:, 1]).max() == pytest.approx(REACH * 3.0, rel=0.02)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("wrost", 'unknown aggregate "wrost" (did you mean "worst"?)'),
        ("quantile", 'such as "quantile 0.9"'),
        ("quantile 1.5", "above 0 and at most 1"),
        ("mean 3", '"mean" takes no number'),
        ("served", 'such as "served 60 deg"'),
        ("served 60", "a number without a unit"),
        ("served 6 mm", "not an angle"),
    ],
)
def test_bad_aggregates(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        aggregate(text, -1.0, ANGLE)
    assert message in str(caught.value)
