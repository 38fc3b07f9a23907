from __future__ import annotations

import math

import numpy as np
import pytest

from .comparison import at_least, compare, verdict


def test_the_largest_deviation_is_shown_over_the_scale() -> None:
    found = compare("x", [1.0, -4.0, 2.0], [1.0, -4.2, 2.1], 0.06)
    assert (found.reference, found.ours, found.count) == (-4.0, -4.2, 3)
    assert found.error == pytest.approx(0.05)
    assert found.passed
    assert not compare("x", [1.0, -4.0, 2.0], [1.0, -4.2, 2.1], 0.04).passed


def test_a_given_scale_measures() -> None:
    assert compare("x", 0.0, 1e-3, 1e-2, 1.0).error == pytest.approx(1e-3)
    assert compare("x", 0.0, 1e-3, 1e-2, 0.01).error == pytest.approx(0.1)


@pytest.mark.parametrize(("reference", "ours"), [(np.nan, 1.0), (1.0, np.nan), (1.0, np.inf)])
def test_what_is_no_number_fails(reference: float, ours: float) -> None:
    found = compare("x", [1.0, reference], [1.0, ours], 1e6, 1.0)
    assert not found.passed
    assert not math.isfinite(found.reference) or not math.isfinite(found.ours)


@pytest.mark.parametrize(
    ("reference", "ours", "scale"),
    [([1.0, 2.0], [1.0], None), ([], [], 1.0), (0.0, 0.0, None), (1.0, 1.0, 0.0)],
)
def test_comparisons_that_could_not_fail_are_refused(reference, ours, scale) -> None:
    with pytest.raises(ValueError, match="x: "):
        compare("x", reference, ours, 1.0, scale)


def test_verdicts_agree_or_fail() -> None:
    assert verdict("state", "stable", "stable").passed
    assert not verdict("state", "stable", "unstable").passed


def test_orders_may_exceed_but_not_fall_short() -> None:
    assert at_least("order", 4.0, 5.0, 0.1).passed
    assert at_least("order", 4.0, 3.95, 0.1).passed
    assert not at_least("order", 4.0, 3.8, 0.1).passed
    assert not at_least("order", 4.0, math.nan, 0.1).passed
