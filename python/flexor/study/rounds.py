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

# Cases of a design beyond which a search begins with the model as it is.
MANY = 8

Stage = tuple[Search, FloatArray | None, Budget]


def rounds(
    study: Study, search: Search, start: FloatArray | None, budget: Budget
) -> Iterator[Stage]:
    """Yield the search of each round, where it starts and its budget; prepare the study for it.

    There is one round without tolerances and with few scenarios. Each of the others begins at the
    optimum of the one before, and the study has the problem and the record of the last.
    """
    corners: list[FloatArray] = []
    near = getattr(search, "from_optimum", search)
    problem, limit, used = study.problem, budget.evaluations, 0
    if isinstance(problem, ScenarioProblem) and problem.count > MANY and near != search:
        # The best of the model as it is, which takes as many times less, is a good beginning.
        study.take_nominal()
        half = None if limit is None else max(limit // 2, 1)
        yield search, start, Budget(half, budget.seconds)
        best = study.record.best()
        start = np.atleast_2d(problem.parameters.start if best is None else best)
        used += _asked(study)
        search, budget = near, _left(used, limit, budget)
    _begin(study, corners)
    yield search, start, budget
    used += _asked(study)
    if not isinstance(problem, ScenarioProblem) or not problem.tolerances:
        return
    while len(corners) < ROUNDS and (best := study.record.best()) is not None:
        errors = next_corners(study.problem, worst_errors(study.problem, best))  # type: ignore[arg-type]
        if errors is None:
            return
        if limit is not None and used >= limit:
            return
        corners.append(errors)
        _begin(study, corners)
        yield near, np.atleast_2d(best), _left(used, limit, budget)
        used += _asked(study)


def _asked(study: Study) -> int:
    """Return the designs that the last search asked for, recorded before or not."""
    return 0 if study.result is None else study.result.evaluations


def _left(used: int, limit: int | None, budget: Budget) -> Budget:
    return Budget(None if limit is None else max(limit - used, 1), budget.seconds)


def _begin(study: Study, corners: list[FloatArray]) -> None:
    study.record.database.note("rounds", [each.tolist() for each in corners])
    study.take_round(corners)
