"""Rounds of a search, each with the errors that the optimum of the last one did not bear."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from flexor.optimizers import Budget, Search, SearchResult
from flexor.study.margins import ROUNDS, next_corners, worst_errors
from flexor.study.problem import FloatArray
from flexor.study.scenario_problem import ScenarioProblem

if TYPE_CHECKING:
    from flexor.study.study import Study

# Cases of a design beyond which a search begins with the model as it is.
MANY = 8
# Evaluations below which what is left of a budget is not divided any more.
LEAST = 20

# Searches the study's problem: by which method, from where, with which budget, and what is said of
# it while it runs.
Run = Callable[[Search, FloatArray | None, Budget, str], SearchResult]


def run_rounds(
    study: Study,
    run: Run,
    search: Search,
    start: FloatArray | None,
    budget: Budget,
    divided: int | None,
) -> str:
    """Search a study's problem in rounds; return why the last of them ended.

    There is one round without tolerances and with few scenarios. Each of the others begins at the
    optimum of the one before, and the study has the problem and the record of the last. A round
    that others may follow takes half of the evaluations that are left, so that the budget does not
    end before the search for a robust design has begun, and goes on if no other has to follow.

    Parameters
    ----------
    study
        The study.
    run
        The search of one round.
    search, start, budget
        As for `Search.minimize`; the budget is that of all rounds.
    divided
        Evaluations that are divided among the rounds: those of the budget, or of the study that is
        repeated with as many evaluations as it has; None if that has no limit.
    """
    problem, corners = study.problem, list[FloatArray]()
    near = getattr(search, "from_optimum", search)
    rounds = _Rounds(study, run, budget, divided)
    if isinstance(problem, ScenarioProblem) and problem.count > MANY and near != search:
        # The best of the model as it is, which takes as many times less, is a good beginning.
        study.take_nominal()
        rounds.begin(search, start, "the model as it is")
        best = study.record.best()
        start, search = np.atleast_2d(problem.parameters.start if best is None else best), near
    toleranced = isinstance(problem, ScenarioProblem) and bool(problem.tolerances)
    _note(study, corners)
    rounds.begin(search, start, "without errors" if toleranced else "", whole=not toleranced)
    while toleranced and (best := study.record.best()) is not None:
        # Where nothing keeps the constraints for the errors so far, more of them do not help.
        feasible = study.record.outcomes(best).violation[0] == 0.0
        worst = worst_errors(study.problem, best) if feasible else None  # type: ignore[arg-type]
        errors = None if worst is None else next_corners(study.problem, worst)  # type: ignore[arg-type]
        if errors is None and rounds.may_go_on:
            rounds.go_on()
        elif errors is None or rounds.spent or len(corners) == ROUNDS:
            robust = worst is not None and worst.kept
            drawn = feasible or bool(corners)
            early = rounds.spent and drawn and not robust
            return f"{rounds.reason}{' before a robust design was found' if early else ''}"
        else:
            corners.append(errors)
            _note(study, corners)
            stage = f"round {len(corners)} with worst errors"
            rounds.begin(near, np.atleast_2d(best), stage, whole=rounds.few)
    return rounds.reason


class _Rounds:
    """Searches that share a budget."""

    def __init__(self, study: Study, run: Run, budget: Budget, divided: int | None) -> None:
        self._study, self._run, self._budget = study, run, budget
        self._left = budget.evaluations  # None without a limit
        self._divided = divided
        self._asked = 0  # of this round

    def begin(
        self, search: Search, start: FloatArray | None, stage: str, whole: bool = False
    ) -> None:
        """Search with a share of what is left, or with all of it."""
        self._asked, self._stage = 0, (search, start, stage)
        self._search(whole)

    def go_on(self) -> None:
        """Continue the round, which repeats what it has recorded, with a share of what is left."""
        self._search(self.few)

    @property
    def few(self) -> bool:
        """Whether too little is left to be divided."""
        return self._divided is not None and self._divided < LEAST

    @property
    def may_go_on(self) -> bool:
        """Whether the round ended with its share, and there is more."""
        return self._cut and not self.spent

    @property
    def spent(self) -> bool:
        """Whether nothing is left."""
        return self._left is not None and self._left <= 0

    @property
    def reason(self) -> str:
        """Why the last round ended."""
        if self.spent:
            return f"the budget of {self._budget.evaluations} evaluations is spent"
        assert self._study.result is not None
        return self._study.result.reason

    def _search(self, whole: bool) -> None:
        search, start, stage = self._stage
        share = self._share(whole)
        limit = None if share is None else self._asked + share
        found = self._run(search, start, Budget(limit, self._budget.seconds), stage)
        self._study.result = found
        more, self._asked = found.evaluations - self._asked, found.evaluations
        self._cut = limit is not None and found.evaluations >= limit
        self._left = None if self._left is None else self._left - more
        self._divided = None if self._divided is None else self._divided - more

    def _share(self, whole: bool) -> int | None:
        half = None if whole or self._divided is None else self._divided // 2
        given = [each for each in (half, self._left) if each is not None]
        return max(min(given), 1) if given else None


def _note(study: Study, corners: list[FloatArray]) -> None:
    study.record.database.note("rounds", [each.tolist() for each in corners])
    study.take_round(corners)
