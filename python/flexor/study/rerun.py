"""Run a study again from its folder, and compare every bit."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.design import ParameterSet
from flexor.errors import InputError
from flexor.objectives import Objective
from flexor.optimizers import Budget, Search
from flexor.optimizers import method as named_method
from flexor.study.executors import AnyExecutor
from flexor.study.optimization import run_search
from flexor.study.problem import FloatArray
from flexor.study.record import Record
from flexor.study.settings import Settings
from flexor.study.study import Study, StudyCallback

if TYPE_CHECKING:
    from flexor.model import Model

# Arrays of the record that are compared.
_COLUMNS = (
    *("value", "objective_values", "shown", "reason", "joint_angles", "tip_force", "touching"),
    *("converged", "stable", "event_count", "total_iterations", "constraint_values", "violation"),
)
_READ_AS = {
    "event_count": "events",
    "total_iterations": "iterations",
    "objective_values": "objectives",
    "constraint_values": "constraints",
}


@dataclass(frozen=True)
class Changed:
    """A version or a system that differs from the recorded one; ``then`` is None without record."""

    what: str
    then: str | None
    now: str


@dataclass(frozen=True)
class Difference:
    """The first difference between a study and its repetition."""

    evaluation: int  # from 1; 0 for the study as a whole
    what: str  # ``design`` if the search proposed another, or the name of the result
    then: str  # as recorded
    now: str


@dataclass(frozen=True)
class Rerun:
    """A repeated study."""

    study: Study  # the repetition, in memory or in a folder of its own
    evaluations: int  # that were recorded
    difference: Difference | None  # the first; None if every bit is the same
    common: int  # designs that both evaluated
    deviation: float  # largest difference of their values; +inf if one failed in one study only
    changed: tuple[Changed, ...]  # versions and system that have changed

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
    """Repeat a study from its folder, which is only read, and compare every bit.

    A study that has not ended, or was ended by time, is run to as many evaluations as it has.

    Parameters
    ----------
    folder : path
        The study folder.
    into : path, optional
        Folder of the new study; in memory by default.
    progress, executor : optional
        As for `flexor.optimize`.
    model, parameters, objective, method : optional
        Override those named in the folder; required if they are user-defined.

    Returns
    -------
    Rerun
        Whether the results are identical and, if not, the first difference and its possible causes.

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
        recorded = then.evaluations
        if recorded == 0:
            raise InputError(f'the study "{place}" has no evaluation that could be run again.')
        given = Budget(**values["budget"])
        whole = then.finished is not None and given.seconds is None
        whole &= given.evaluations is None or given.evaluations >= recorded
        options = values["method"]["options"]
        now = run_search(
            then.settings.kind,
            then.problem,
            method if method is not None else named_method(values["method"]["name"], **options),
            "random" if values["start"] is None else values["start"],
            seed=values["seed"],
            budget=given if whole else Budget(evaluations=recorded),
            planned=then.record.database.noted("budgets") or [given.evaluations],
            folder=into,
            progress=progress,
            executor=executor,
        )
        common, deviation = _deviation(record, now.record)
        return Rerun(
            study=now,
            evaluations=recorded,
            difference=_first_difference(then, now, whole),
            common=common,
            deviation=deviation,
            changed=_changed(then.settings, now.settings),
        )
    finally:
        then.close()


def _first_difference(then: Study, now: Study, whole: bool) -> Difference | None:
    for old, new in zip(then.records, now.records, strict=False):
        if (found := _in_round(old, new)) is not None:
            return found
    if then.evaluations != now.evaluations:
        return _difference(0, "evaluations", then.evaluations, now.evaluations)
    if whole and then.finished != now.finished:
        return _difference(0, "end", then.finished, now.finished)
    return None


def _in_round(old: Record, new: Record) -> Difference | None:
    columns = {"design": (old.designs(), new.designs())}
    outcomes = old.outcomes(), new.outcomes()
    columns |= {name: tuple(getattr(paths, name) for paths in outcomes) for name in _COLUMNS}
    for row in range(min(len(old), len(new))):
        for name, (before, after) in columns.items():  # the design itself before its outcomes
            if _bits(before[row]) != _bits(after[row]):
                return _difference(row + 1, _READ_AS.get(name, name), before[row], after[row])
    for row, design in enumerate(columns["design"][0][: len(new)]):
        slopes = _slopes(old, design), _slopes(new, design)
        if _bits(slopes[0]) != _bits(slopes[1]):
            return _difference(row + 1, "derivatives", *slopes)
    return None


def _slopes(record: Record, design: FloatArray) -> tuple[Any, ...]:
    found = record.outcomes(design)
    regularity = None if found.regularity is None else str(found.regularity[0])
    return found.derivatives, found.value_gradient, found.constraint_gradients, regularity


def _bits(value: Any) -> Any:
    if isinstance(value, tuple):
        return tuple(map(_bits, value))
    return value.tobytes() if isinstance(value, (np.ndarray, np.generic)) else value


def _difference(evaluation: int, what: str, *values: Any) -> Difference:
    first = (value[0] if isinstance(value, tuple) else value for value in values)
    plain = (v.tolist() if isinstance(v, (np.ndarray, np.generic)) else v for v in first)
    return Difference(evaluation, what, *map(str, plain))


def _deviation(old: Record, new: Record) -> tuple[int, float]:
    """Designs that both have, and the largest difference of their values."""
    before, after = old.known(), new.known()
    both = before.keys() & after.keys()
    # Equal infinities have no difference.
    apart = (abs(before[key] - after[key]) for key in both if before[key] != after[key])
    return len(both), max(apart, default=0.0)


def _changed(then: Settings, now: Settings) -> tuple[Changed, ...]:
    old, new = (
        {"flexor": each["flexor"], "model": each["model"]["hash"], **each["environment"]}
        for each in (then.values, now.values)
    )
    return tuple(
        Changed(what, old.get(what), value) for what, value in new.items() if old.get(what) != value
    )
