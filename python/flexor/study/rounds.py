"""Rounds of a search, each with the errors that the optimum of the last one did not bear."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from flexor.constraints import ranks
from flexor.optimizers import Budget, Search, SearchResult
from flexor.store import Database
from flexor.study.margins import ROUNDS, next_corners, worst_errors
from flexor.study.problem import FloatArray
from flexor.study.scenario_problem import ScenarioProblem

if TYPE_CHECKING:
    from flexor.study.study import Study

# Cases of a design beyond which a search begins with the model as it is.
MANY = 8
# Designs of that search, and how far they are apart as shares of the ranges, from which the search
# over all cases begins.
SEVERAL, APART = 4, 0.1
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
    divided: Sequence[int | None],
) -> str:
    """Search a study's problem in rounds; return why the last of them ended.

    There is one round without tolerances and with few scenarios. Each of the others begins at the
    optimum of the one before, and the study has the problem and the record of the last. A round
    that others may follow takes half of the evaluations that are left, so that the budget does not
    end before the search for a robust design has begun, and goes on if no other has to follow.

    What happens follows from the results of the searches and never from what else is recorded, so
    that a search that is repeated, with the same budget or another, takes the same way.

    Parameters
    ----------
    study
        The study.
    run
        The search of one round.
    search, start, budget
        As for `Search.minimize`; the budget is that of all rounds.
    divided
        Evaluations that are divided among the rounds, one after the other and in ascending order:
        those of the budget, after those of smaller ones with which the search was begun; None for
        no limit.
    """
    problem, corners = study.problem, list[FloatArray]()
    near = getattr(search, "from_optimum", search)
    many = isinstance(problem, ScenarioProblem) and problem.count > MANY
    rounds = _Rounds(study, run, budget, divided)
    if many and near != search:
        # The best of the model as it is, which takes as many times less, is a good beginning.
        study.take_nominal()
        rounds.begin(search, start, "the model as it is")
        several = _several(study)
        start, search = several if len(several) else problem.parameters.start[None, :], near
    # A share that is served counts errors as samples.
    toleranced = (
        isinstance(problem, ScenarioProblem)
        and bool(problem.tolerances)
        and problem.aggregate.everywhere
    )
    _note(study, corners)
    rounds.begin(search, start, "without errors" if toleranced else "", whole=not toleranced)
    while toleranced and (best := rounds.best) is not None:
        errors, robust, drawn = _next_errors(study, best)
        study.record.database.note("robust", robust)
        if errors is None and rounds.may_go_on:
            rounds.go_on()
        elif errors is None or rounds.spent or len(corners) == ROUNDS:
            early = rounds.spent and drawn and not robust
            return f"{rounds.reason}{' before a robust design was found' if early else ''}"
        else:
            corners.append(errors)
            _note(study, corners)
            stage = f"round {len(corners)} with worst errors"
            rounds.begin(near, np.atleast_2d(best), stage, few=True)
    return rounds.reason


def _several(study: Study) -> FloatArray:
    """Return the best designs of a search (s, k) that are apart from each other, the best first."""
    chosen, record = study.problem.parameters, study.record
    designs, outcomes = record.designs(), record.outcomes()
    inside = (designs - chosen.lower) / (chosen.upper - chosen.lower)
    order = np.argsort(ranks(outcomes.value, outcomes.violation), kind="stable")
    rows: list[int] = []
    for row in order[np.isfinite(outcomes.value[order])].tolist():
        if len(rows) < SEVERAL and (np.abs(inside[rows] - inside[row]).max(axis=1) > APART).all():
            rows.append(row)
    return designs[rows]


def _next_errors(study: Study, best: FloatArray) -> tuple[FloatArray | None, bool, bool]:
    """Return the errors of the round after this one, and what is known of its optimum.

    That is whether it keeps the constraints for every error within the tolerances, and whether a
    robust design may exist. What was found once is in the record.
    """
    database: Database = study.record.database
    known = database.noted("worst") or {}
    key = f"{study.record.search}: {(best + 0.0).astype('<f8').tobytes().hex()}"
    if key not in known:
        # Where nothing keeps the constraints for the errors so far, more of them do not help.
        feasible = bool(study.record.outcomes(best).violation[0] == 0.0)
        problem = study.problem
        assert isinstance(problem, ScenarioProblem)
        worst = worst_errors(problem, best) if feasible else None
        errors = None if worst is None else next_corners(problem, worst)
        known[key] = {
            "errors": None if errors is None else errors.tolist(),
            "robust": worst is not None and worst.kept,
            "drawn": feasible or len(problem.corners) > 0,
        }
        database.note("worst", known)
    found = known[key]
    errors = None if found["errors"] is None else np.array(found["errors"], dtype=np.float64)
    return errors, found["robust"], found["drawn"]


class _Rounds:
    """Searches that share a budget."""

    def __init__(
        self, study: Study, run: Run, budget: Budget, divided: Sequence[int | None]
    ) -> None:
        self._study, self._run, self._budget = study, run, budget
        self._limits = list(divided)  # the first is divided now
        self._spent = 0
        self._asked = 0  # of this round

    def begin(
        self,
        search: Search,
        start: FloatArray | None,
        stage: str,
        *,
        whole: bool = False,
        few: bool = False,
    ) -> None:
        """Search with a share of what is left: all of it, or all that is too ``few`` to divide."""
        self._asked, self._stage = 0, (search, start, stage)
        self._search(whole, few)

    def go_on(self) -> None:
        """Continue the round, which repeats what it has recorded, with a share of what is left."""
        self._search(whole=False, few=True)

    @property
    def best(self) -> FloatArray | None:
        """Best design (k,) of the last search; None if none succeeded."""
        found = self._study.result
        assert found is not None
        return found.design if np.isfinite(found.value) else None

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

    @property
    def _left(self) -> int | None:
        most = self._budget.evaluations
        return None if most is None else most - self._spent

    def _search(self, whole: bool, few: bool) -> None:
        search, start, stage = self._stage
        share = self._left if whole else self._share(few)
        limit = None if share is None else self._asked + max(share, 1)
        found = self._run(search, start, Budget(limit, self._budget.seconds), stage)
        self._study.result = found
        self._spent += found.evaluations - self._asked
        self._asked = found.evaluations
        self._cut = limit is not None and found.evaluations >= limit

    def _share(self, few: bool) -> int | None:
        while len(self._limits) > 1 and self._limits[0] <= self._spent:  # type: ignore[operator]
            self._limits.pop(0)
        first = self._limits[0]
        if first is None:
            return self._left
        share = first - self._spent
        if not few or share >= LEAST:
            share //= 2
        return share if self._left is None else min(share, self._left)


def _note(study: Study, corners: list[FloatArray]) -> None:
    study.record.database.note("rounds", [each.tolist() for each in corners])
    study.take_round(corners)
