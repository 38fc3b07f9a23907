"""Sizes: a few designs that together serve the wearers of a population best."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexor.arguments import integer
from flexor.constraints import ranks
from flexor.design import ParameterSet
from flexor.errors import InputError
from flexor.optimizers import Budget, Search
from flexor.optimizers import method as named_method
from flexor.scenarios import Scenario
from flexor.scenarios.aggregate import SHORTFALL
from flexor.scenarios.scenario import Given
from flexor.store import write_text
from flexor.study.dependence import check_problem
from flexor.study.design import Design
from flexor.study.executors import AnyExecutor
from flexor.study.members import SIZES
from flexor.study.optimization import run_search
from flexor.study.problem import FloatArray, Problem
from flexor.study.scenario_problem import ScenarioProblem, Uncertainty
from flexor.study.settings import STUDY
from flexor.study.study import Study, StudyCallback

if TYPE_CHECKING:
    from flexor.model import Model

# Designs all over the bounds among which the first sizes are chosen, besides optima of the model.
POOL = 64
# Times that wearers are given to sizes and sizes fitted to their wearers.
TURNS = 3
# Of a wearer whom a design fails.
_FAILED = 1e15


@dataclass(frozen=True, eq=False)
class Sizes:
    """Designs that together serve a population; made by `sizes`."""

    problem: ScenarioProblem  # over all wearers
    studies: tuple[Study, ...]  # of each size, over the wearers whom it serves
    wearers: tuple[Scenario, ...]  # S
    size: NDArray[np.intp]  # (S,), which size a wearer gets; -1 for none that serves
    shown: FloatArray  # (sizes, S), the objective's quantity of each wearer with each size
    kept: NDArray[np.bool_]  # (sizes, S), whether the constraints hold

    @property
    def served(self) -> float:
        """Share of the wearers' weight that a size serves."""
        weights = np.array([each.weight for each in self.wearers])
        return float(weights[self.size >= 0].sum() / weights.sum())

    def members(self, size: int) -> tuple[Scenario, ...]:
        """Return the wearers whom a size serves."""
        return tuple(self.wearers[i] for i in np.flatnonzero(self.size == size))

    def design(self, size: int) -> Design | None:
        """Return a size as the design of those whom it serves; None if that is no one."""
        chosen = self.size == size
        if not chosen.any():
            return None
        problem, vector = _only(self.problem, chosen), self.studies[size].best.vector
        return Design.of(problem, vector, problem.evaluate(vector[None, :]))

    def close(self) -> None:
        """Close the records."""
        for study in self.studies:
            study.close()


def sizes(
    model: Model | str | PathLike[str],
    parameters: str | ParameterSet | Mapping[str, Sequence[object]],
    objective: str | Sequence[str],
    count: int,
    *,
    subject_to: Sequence[str] = (),
    without: Sequence[str] = (),
    scenarios: Given = (),
    wearers: int = 0,
    aggregate: str = "mean",
    method: str | Search = "auto",
    seed: int = 0,
    budget: int | None = None,
    folder: str | Path | None = None,
    progress: StudyCallback | None = None,
    executor: AnyExecutor | None = None,
    method_options: Mapping[str, Any] | None = None,
    engine_options: Mapping[str, float] | None = None,
    force: Any = None,
) -> Sizes:
    """Find so many designs that together serve wearers best, and whom each serves.

    The first are chosen among designs all over the bounds and the optimum of the model as it is;
    then wearers get the size that is best for them and each size is optimised for its wearers, in
    turn, until wearers no longer change or for three turns. A wearer counts as served if the
    constraints hold and, with an aggregate such as ``"served 60 deg"``, that is reached.

    Parameters
    ----------
    model, parameters, objective, subject_to, without, method, force
        As for `flexor.optimize`.
    count
        Number of sizes.
    scenarios, wearers, aggregate
        As for `flexor.optimize`: whom they are for.
    seed, budget, progress, executor, method_options, engine_options
        As for `flexor.optimize`; the budget is that of each search.
    folder
        Folder of the studies ``size-1`` and so on, one for each size; in memory by default.

    Raises
    ------
    InputError
        As `flexor.optimize`, or if there are fewer wearers than sizes.
    """
    count = integer("sizes", count, 1)
    nominal = Problem.of(
        model,
        parameters,
        objective,
        force,
        None,
        engine_options,
        subject_to,
        without,
    )
    stated = Uncertainty(scenarios, aggregate, {}, 0, integer("wearers", wearers, 0))
    whole = ScenarioProblem.over(nominal, stated, integer("seed", seed, 0))
    if len(whole.scenarios) < count:
        raise InputError(
            f"sizes is {count}, more than the {len(whole.scenarios)} wearers and scenarios that "
            "they are for: give --wearers, a number of at least as many."
        )
    check_problem(nominal)
    search = named_method(method, **(method_options or {})) if isinstance(method, str) else method
    local, limit = getattr(search, "from_optimum", search), Budget(evaluations=budget)

    def searched(
        problem: Problem, how: Search, start: FloatArray, place: Path | None = None
    ) -> Study:
        options: dict[str, Any] = {"progress": progress, "executor": executor, "folder": place}
        return run_search(STUDY, problem, how, start, seed=seed, budget=limit, **options)

    first = searched(nominal, search, nominal.parameters.start).best.vector
    pool = np.concatenate([first[None], nominal.parameters.start[None], _spread(nominal, seed)])
    cost = _cost(whole, pool)
    weights = np.array([each.weight for each in whole.scenarios])
    chosen = pool[_choose(cost, weights, count)]
    cost = _cost(whole, chosen)
    for _ in range(TURNS):
        given = cost.argmin(axis=0)
        better = [
            searched(_only(whole, given == i), local, each).best.vector
            if (given == i).any()
            else each
            for i, each in enumerate(chosen)
        ]
        new = _cost(whole, np.stack(better))
        if not weights @ new.min(axis=0) < weights @ cost.min(axis=0):
            break
        done = (new.argmin(axis=0) == given).all()
        chosen, cost = np.stack(better), new
        if done:
            break
    given = cost.argmin(axis=0)
    used = [i for i in range(count) if (given == i).any()]
    place = None if folder is None else Path(folder)
    studies = tuple(
        searched(
            _only(whole, given == i),
            local,
            chosen[i],
            None if place is None else place / f"size-{number}",
        )
        for number, i in enumerate(used, start=1)
    )
    found = _sorted(whole, studies)
    if place is not None:
        _note_sizes(place, found)
    return found


def _sorted(whole: ScenarioProblem, studies: Sequence[Study]) -> Sizes:
    """Give every wearer the size that is best for them."""
    designs = np.stack([each.best.vector for each in studies])
    value, broken, shown = _tables(whole, designs)
    cost = _cost_of(whole, value, broken)
    given = cost.argmin(axis=0)
    each = np.arange(len(given))
    kept = np.isfinite(value) & (broken == 0.0)
    served = kept[given, each]
    if not whole.aggregate.everywhere:
        served = whole.aggregate.shortfalls(value, broken)[given, each] <= 0.0
    given = np.where(served, given, -1)
    return Sizes(whole, tuple(studies), whole.scenarios, given, shown, kept)


def _note_sizes(place: Path, found: Sizes) -> None:
    """Write whom the sizes serve; the one that serves most comes first."""
    rows = []
    for i, study in enumerate(found.studies):
        members = found.members(i)
        rows.append(
            {
                "study": Path(study.folder or "").name,
                "weight": sum(each.weight for each in members),
                "wearers": [each.name for each in members],
            }
        )
    rows.sort(key=lambda row: -row["weight"])  # type: ignore[operator]
    written = {"format": 1, "served": found.served, "sizes": rows}
    write_text(place / SIZES, json.dumps(written, indent=2))


def _only(whole: ScenarioProblem, chosen: NDArray[np.bool_]) -> ScenarioProblem:
    """Return the problem over some of the wearers."""
    rows = np.flatnonzero(chosen)
    made = replace(whole, scenarios=tuple(whole.scenarios[i] for i in rows))
    made.__dict__["cases"] = tuple(whole.cases[i] for i in rows)  # models and maps stay
    made.__dict__["models"] = tuple(whole.models[i] for i in rows)
    return made


def _tables(whole: ScenarioProblem, designs: FloatArray) -> tuple[FloatArray, ...]:
    """Return value, violation and quantity of designs (n, k) for each wearer, each (n, S)."""
    found = whole.by_case(designs, np.zeros((1, len(whole.tolerances))))
    names = ("value", "violation", "shown")
    return tuple(np.stack([getattr(each, name) for each in found], axis=1) for name in names)


def _cost(whole: ScenarioProblem, designs: FloatArray) -> FloatArray:
    value, broken, _ = _tables(whole, designs)
    return _cost_of(whole, value, broken)


def _cost_of(whole: ScenarioProblem, value: FloatArray, broken: FloatArray) -> FloatArray:
    """Return what designs cost each wearer, (n, S): the less, the better they are served."""
    if not whole.aggregate.everywhere:
        short = whole.aggregate.shortfalls(value, broken)
        return np.where(short > 0.0, SHORTFALL * np.minimum(short, 1.0), -1.0)
    cost = ranks(value, broken)
    return np.where(np.isfinite(cost), cost, _FAILED)


def _choose(cost: FloatArray, weights: FloatArray, count: int) -> list[int]:
    """Choose designs of which each wearer gets the best: greedily, then by exchanging one."""
    chosen: list[int] = []

    def total(rows: list[int]) -> float:
        return float(weights @ cost[rows].min(axis=0))

    for _ in range(min(count, len(cost))):
        left = [i for i in range(len(cost)) if i not in chosen]
        chosen.append(min(left, key=lambda i: total([*chosen, i])))
    better = True
    while better:
        better = False
        for place in range(len(chosen)):
            for i in range(len(cost)):
                changed = [*chosen[:place], i, *chosen[place + 1 :]]
                if total(changed) < total(chosen):
                    chosen, better = changed, True
    return chosen


def _spread(problem: Problem, seed: int) -> FloatArray:
    from scipy.stats import qmc  # deferred: slow to import

    chosen = problem.parameters
    unit = qmc.Sobol(chosen.size, scramble=True, seed=seed).random(POOL)
    return np.asarray(chosen.lower + unit * (chosen.upper - chosen.lower))
