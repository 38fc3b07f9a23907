"""Progress of a running study."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from flexor.study.design import Design


@dataclass(frozen=True, eq=False)
class StudyProgress:
    """Where a study stands.

    Attributes
    ----------
    best : Design or None
        Best design so far; None while every design has failed.
    evaluations : int
        Distinct designs the search has asked for.
    evaluated, replayed : int
        How many of them were evaluated now, and how many were known from an earlier run.
    iteration : int
        Iterations of the method.
    seconds : float
        Time since the study began or was resumed.
    remaining : int or None
        Evaluations still to come: to the end of the budget, or if nothing better is found any
        more, whichever is fewer; None if neither is known.
    detail : str
        In the method's own words.
    """

    best: Design | None
    evaluations: int
    evaluated: int
    replayed: int
    iteration: int
    seconds: float
    remaining: int | None
    detail: str

    @property
    def rate(self) -> float:
        """Designs evaluated per second."""
        return self.evaluated / self.seconds if self.seconds > 0.0 else 0.0

    @property
    def seconds_left(self) -> float | None:
        """Time to the end at this rate, if it can be told."""
        if self.remaining is None or self.rate == 0.0:
            return None
        return self.remaining / self.rate


StudyCallback = Callable[[StudyProgress], None]
