"""Run a study again from its folder, and compare every bit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexor.design import ParameterSet
from flexor.errors import InputError
from flexor.objectives import Objective
from flexor.optimizers import Budget, Search
from flexor.optimizers import method as named_method
from flexor.study.executors import AnyExecutor
from flexor.study.optimization import optimize
from flexor.study.progress import StudyCallback
from flexor.study.record import Record
from flexor.study.settings import Settings
from flexor.study.study import Study

if TYPE_CHECKING:
    from flexor.model import Model

# Arrays of the record that are compared, by the names that people read.
_COLUMNS = {
    **{name: name for name in ("value", "shown", "reason", "joint_angles", "tip_force")},
    **{name: name for name in ("touching", "converged", "stable")},
    "events": "event_count",
    "iterations": "total_iterations",
}


@dataclass(frozen=True)
class Changed:
    """Something a study was made with that is another now; None if it was not recorded."""

    what: str
    then: str | None
    now: str


@dataclass(frozen=True)
class Difference:
    """The first thing that came out otherwise.

    Attributes
    ----------
    evaluation : int
        Of which evaluation, counted from 1; 0 for the study as a whole.
    what : str
        ``design`` if the search asked for another, or which outcome.
    then, now : str
        As recorded, and as it is now.
    """

    evaluation: int
    what: str
    then: str
    now: str


@dataclass(frozen=True)
class Rerun:
    """A study run again.

    Attributes
    ----------
    study : Study
        The study as it is now, in memory or in a folder of its own.
    evaluations : int
        How many were recorded.
    difference : Difference or None
        The first; None if every bit is the same.
    common : int
        Designs that both evaluated.
    deviation : float
        Largest difference of the objective's value over these; +inf where one failed and the other
        did not.
    changed : tuple of Changed
        Versions and machine that are not those of the study.
    """

    study: Study
    evaluations: int
    difference: Difference | None
    common: int
    deviation: float
    changed: tuple[Changed, ...]

    @property
    def same(self) -> bool:
        """Whether every design, outcome and derivative is the same to the last bit."""
        return self.difference is None


def rerun(
    folder: str | Path,
    *,
    into: str | Path | None = None,
    progress: StudyCallback | None = None,
    executor: AnyExecutor | None = None,
    model: Model | None = None,
    parameters: ParameterSet | None = None,
    objective: Objective | None = None,
    method: Search | None = None,
) -> Rerun:
    """Run a study again from its folder, which is only read, and compare every bit.

    A study that has not ended, or was ended by time, is run to as many evaluations as it has.

    Parameters
    ----------
    folder : path
        The study folder.
    into : path, optional
        Where to keep the new study; in memory by default.
    progress, executor : optional
        As for `flexor.optimize`.
    model, parameters, objective, method : optional
        In place of those that the folder names; needed for a user's own.

    Returns
    -------
    Rerun
        Whether it came out the same and, if not, what differs first and what it may come from.

    Raises
    ------
    InputError
        If the folder is not a study, is damaged, has no evaluation yet, or names something that is
        not known.
    """
    place = Path(folder)
    then = Study.open(place, model=model, parameters=parameters, objective=objective)
    try:
        values, record = then.settings.values, then.record
        recorded = len(record)
        if recorded == 0:
            raise InputError(f'the study "{place}" has no evaluation that could be run again.')
        given = Budget(**values["budget"])
        whole = then.finished is not None and given.seconds is None
        whole &= given.evaluations is None or given.evaluations >= recorded
        options = values["method"]["options"]
        now = optimize(
            then.problem.model,
            then.problem.parameters,
            then.problem.objective,
            method if method is not None else named_method(values["method"]["name"], **options),
            start="random" if values["start"] is None else values["start"],
            seed=values["seed"],
            budget=given if whole else Budget(evaluations=recorded),
            folder=into,
            progress=progress,
            executor=executor,
            engine_options=then.problem.options,
        )
        common, deviation = _deviation(record, now.record)
        return Rerun(
            study=now,
            evaluations=recorded,
            difference=_first_difference(then, now, whole),
            common=common,
            deviation=deviation,
            changed=tuple(_changed(then.settings, now.settings)),
        )
    finally:
        then.close()


def _first_difference(then: Study, now: Study, whole: bool) -> Difference | None:
    old, new = then.record, now.record
    designs = old.designs(), new.designs()
    outcomes = old.outcomes(), new.outcomes()
    columns = {"design": designs}
    for name, array in _COLUMNS.items():
        columns[name] = getattr(outcomes[0], array), getattr(outcomes[1], array)
    rows = {name: row for name, pair in columns.items() if (row := _first_row(*pair)) is not None}
    if rows:
        name = min(rows, key=lambda each: rows[each])  # the design itself before its outcomes
        row = rows[name]
        return Difference(row + 1, name, *(_shown(column[row]) for column in columns[name]))
    for row, design in enumerate(designs[0][: len(designs[1])]):
        slopes = old.derivatives(design), new.derivatives(design)
        if _bits(slopes[0]) != _bits(slopes[1]):
            return Difference(row + 1, "derivatives", *(_shown(each) for each in slopes))
    if len(old) != len(new):
        return Difference(0, "evaluations", str(len(old)), str(len(new)))
    ended = now.result.reason if now.result is not None else None
    if whole and then.finished != ended:
        return Difference(0, "end", str(then.finished), str(ended))
    return None


def _first_row(one: NDArray[Any], other: NDArray[Any]) -> int | None:
    """First row that is not the same to the last bit, of those that both have."""
    count = min(len(one), len(other))
    if count == 0:
        return None
    pair = [np.ascontiguousarray(each[:count]) for each in (one, other)]
    if one.dtype == object:
        differs = pair[0] != pair[1]
    else:
        old, new = (each.reshape(count, -1).view(np.uint8) for each in pair)
        differs = (old != new).any(axis=1)
    return int(np.argmax(differs)) if differs.any() else None


def _bits(slopes: tuple[NDArray[np.float64], str] | None) -> tuple[bytes, str] | None:
    return None if slopes is None else (slopes[0].tobytes(), slopes[1])


def _shown(value: Any) -> str:
    if isinstance(value, tuple):
        value = value[0]
    return str(value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value)


def _deviation(old: Record, new: Record) -> tuple[int, float]:
    """Designs that both have, and the largest difference of their values."""
    before, after = old.known(), new.known()
    both = [key for key in before if key in after]
    pairs = np.array([(before[key], after[key]) for key in both]).reshape(-1, 2)
    apart = np.zeros(len(pairs))
    different = pairs[:, 0] != pairs[:, 1]  # equal infinities have no difference
    apart[different] = np.abs(pairs[different, 0] - pairs[different, 1])
    return len(both), float(apart.max(initial=0.0))


def _changed(then: Settings, now: Settings) -> Iterator[Changed]:
    old, new = then.values, now.values
    yield from _unequal("flexor", old["flexor"], new["flexor"])
    yield from _unequal("model", old["model"]["hash"], new["model"]["hash"])
    for what, value in new["environment"].items():
        yield from _unequal(what, old["environment"].get(what), value)


def _unequal(what: str, then: str | None, now: str) -> Iterator[Changed]:
    if then != now:
        yield Changed(what, then, now)
