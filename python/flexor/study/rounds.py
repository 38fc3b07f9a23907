"""Rounds of a search, each with the errors that the optimum of the last one did not bear."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from flexor.optimizers import Budget, Search
from flexor.study.margins import ROUNDS, next_corners, worst_errors
from flexor.study.problem import FloatArray
from flexor.study.scenario_problem import ScenarioProblem

if TYPE_CHECKING:
    from flexor.study.study import Study

Stage = tuple[Search, FloatArray | None, Budget]


def rounds(
    study: Study, search: Search, start: FloatArray | None, budget: Budget
) -> Iterator[Stage]:
    """Yield the search of each round, where it starts and its budget; prepare the study for it.

    There is one round without tolerances. With them each of the others begins at the optimum of the
    one before, and the study has the problem and the record of the last.
    """
    corners: list[FloatArray] = []
    _begin(study, corners)
    yield search, start, budget
    problem, spent = study.problem, study.evaluations
    if not isinstance(problem, ScenarioProblem) or not problem.tolerances:
        return
    local = getattr(search, "local", search)
    while len(corners) < ROUNDS and (best := study.record.best()) is not None:
        errors = next_corners(study.problem, worst_errors(study.problem, best))  # type: ignore[arg-type]
        if errors is None:
            return
        left = None if budget.evaluations is None else budget.evaluations - spent
        if left is not None and left <= 0:
            return
        corners.append(errors)
        _begin(study, corners)
        yield local, np.atleast_2d(best), Budget(left, budget.seconds)
        spent = study.evaluations


def _begin(study: Study, corners: list[FloatArray]) -> None:
    study.record.database.note("rounds", [each.tolist() for each in corners])
    study.take_round(corners)
