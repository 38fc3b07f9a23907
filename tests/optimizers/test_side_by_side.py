"""Searches side by side."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing

import numpy as np
import pytest

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.side_by_side import side_by_side

Ask = Callable[[FloatArray], float]


def halving(start: FloatArray, ask: Ask) -> FloatArray:
    """Halve a point until the function is below 1."""
    while ask(start) >= 1.0:
        start = 0.5 * start
    return start


def test_what_searches_ask_for_is_one_batch_and_their_ends_come_in_order() -> None:
    sizes = list[int]()

    def answers(points: list[FloatArray]) -> list[float]:
        sizes.append(len(points))
        return [float(point[0]) for point in points]

    starts = [np.array([value]) for value in (8.0, 0.5, 2.0, 32.0)]
    ends = [float(end[0]) for end in side_by_side(halving, starts, answers, 3)]
    # The second is where it may stay, and the last begins when it has ended.
    assert ends == [0.5, 0.5, 0.5, 0.5]
    assert sizes == [3, 3, 3, 2, 2, 1, 1, 1]


def test_searches_that_are_not_wanted_any_more_end() -> None:
    ended = list[float]()

    def endless(start: FloatArray, ask: Ask) -> FloatArray:
        try:
            while start[0] > 1.0:
                ask(start)
            return start
        finally:
            ended.append(float(start[0]))

    starts = (np.array([value]) for value in (2.0, 0.0, 3.0))
    with closing(side_by_side(endless, starts, lambda points: [0.0] * len(points), 2)) as ends:
        assert float(next(ends)[0]) == 0.0
    assert sorted(ended) == [0.0, 2.0]


def test_errors_are_raised_where_the_searches_are_asked_for() -> None:
    def broken(start: FloatArray, ask: Ask) -> FloatArray:
        ask(start)
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        list(side_by_side(broken, [np.zeros(1)] * 3, lambda points: [0.0] * len(points), 2))
    with pytest.raises(KeyError):
        list(side_by_side(broken, [np.zeros(1)] * 3, lambda points: [{}["none"]], 2))
