"""Discrete choices: a search for each combination, with a shared budget."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import inf, isfinite
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.arguments import integer
from flexor.design import ParameterSet, variables
from flexor.design.choices import Combination, check_chosen, combinations, without_fields
from flexor.errors import InputError
from flexor.model.loading import require_model
from flexor.optimizers import Search
from flexor.optimizers import method as named_method
from flexor.store import SETTINGS, write_text
from flexor.study.executors import AnyExecutor
from flexor.study.members import CHOICES as FILE
from flexor.study.members import is_choices
from flexor.study.optimization import optimize
from flexor.study.optimum import OPTIMUM, called, save_design
from flexor.study.settings import model_files, recorded_model
from flexor.study.study import Study, StudyCallback

if TYPE_CHECKING:
    from flexor.model import Model

# Designs that all combinations have together.
BUDGET = 3000
_FORMAT = 1


@dataclass(frozen=True, eq=False)
class Tried:
    """A combination and what the search for it found."""

    combination: Combination
    study: Study
    rounds: int  # of all, in which it took part
    violation: float  # of its best design; +inf without one
    value: float  # of the objective, likewise
    robust: bool | None  # whether it bears the tolerances; None without these

    @classmethod
    def of(cls, combination: Combination, study: Study, rounds: int) -> Tried:
        """Take what a search has just found."""
        assert study.result is not None
        found = study.record.outcomes(study.result.design)
        ended = bool(np.isfinite(found.value[0]))
        violation, value = (found.violation[0], found.value[0]) if ended else (np.inf, np.inf)
        return cls(combination, study, rounds, float(violation), float(value), study.robust)

    @property
    def name(self) -> str:
        """Name of the combination."""
        return self.combination.name

    @cached_property
    def standing(self) -> int:
        """0 if its best design is feasible and robust, 1 if it is so only as drawn, else 2.

        The violation counts the errors within the tolerances that are known so far, and not every
        search has come to look for them.
        """
        if self.violation == 0.0:
            return int(self.robust is False)
        kept = self.robust is not None and isfinite(self.value)
        return 1 if kept and all(each.state != "BROKEN" for each in self.study.best.kept) else 2

    @property
    def rank(self) -> tuple[int, float, float]:
        """By which combinations are ordered: feasible ones first, of these robust ones."""
        return self.standing, self.violation if self.standing == 2 else 0.0, self.value


@dataclass(frozen=True, eq=False)
class Choices:
    """The best of all combinations of choices; made by `choices`."""

    tried: tuple[Tried, ...]  # the best first, and last what left first
    rounds: int
    folder: Path | None
    evaluated: int = 0  # designs in this process, of all in the records
    failed: Mapping[str, str] = field(default_factory=dict)  # why some could not be searched
    _place: object = None  # keeps a temporary folder

    @property
    def best(self) -> Study:
        """The study of the best combination."""
        return self.tried[0].study

    @property
    def combination(self) -> Combination:
        """The best combination."""
        return self.tried[0].combination

    @property
    def evaluations(self) -> int:
        """Number of distinct designs evaluated for all combinations."""
        return sum(each.study.evaluations for each in self.tried)

    @property
    def robust(self) -> bool | None:
        """Whether the best design keeps the constraints for every error; None without errors."""
        return self.tried[0].robust

    def close(self) -> None:
        """Close the records."""
        for each in self.tried:
            each.study.close()


def choices(
    model: Model | str | PathLike[str],
    parameters: Any,
    objective: Any,
    given: Mapping[str, Sequence[object]],
    *,
    method: str | Search | None = None,
    tolerance: Mapping[str, object] | None = None,
    budget: int | None = None,
    folder: str | Path | None = None,
    resume: bool = False,
    progress: StudyCallback | None = None,
    executor: AnyExecutor | None = None,
    method_options: Mapping[str, Any] | None = None,
    **problem: Any,
) -> Choices:
    """Optimise a design for every combination of discrete choices, and find the best.

    All combinations begin with the same number of designs; then the better half goes on, each with
    twice as many more, until one is left (successive halving, Karnin, Koren and Somekh 2013). In
    every round all together evaluate the same number of designs.

    Parameters
    ----------
    model, parameters, objective, method, method_options, tolerance
        As for `flexor.optimize`, with one objective. Fields of what a combination is without do not
        vary in it.
    given
        Values of each field; see `flexor.design.combinations`.
    budget
        Designs of all combinations together, by default 3,000.
    folder
        Folder of the studies ``1`` and so on, one for each combination; in memory by default.
    resume
        Go on with the work in the folder, which has to be of the same statement. Where that has
        ended nothing is evaluated.
    progress, executor
        As for `flexor.optimize`.
    **problem
        Other options of `flexor.optimize` that state the problem, such as ``subject_to``.

    Raises
    ------
    InputError
        As `flexor.optimize`, if no combination can be searched, and `flexor.design.combinations`.
    """
    model = require_model(model)
    if isinstance(parameters, Mapping):
        check_chosen(given, parameters, model)
    every = combinations(given, model)
    total = integer("budget", BUDGET if budget is None else budget, 1)
    rounds = (len(every) - 1).bit_length() + 1
    kept: tempfile.TemporaryDirectory[str] | None = None
    if folder is None:
        if resume:
            raise InputError("resuming choices needs their folder.")
        kept = tempfile.TemporaryDirectory(prefix="flexor-")
    place = Path(kept.name if kept is not None else str(folder))
    statement = {
        "parameters": parameters,
        "objective": objective,
        "given": given,
        "method": method,
        "tolerance": tolerance,
        "budget": budget,
        "method_options": method_options,
        **problem,
    }
    if resume:
        _check_same(place, statement)
    elif kept is None:
        _begin(place, model, statement)
    # A share of the budget for each round, and in it for each combination that is left.
    share = [max(total // (rounds * -(-len(every) // 2**i)), 1) for i in range(rounds)]
    whole = sum(share)
    if (method is None or method == "auto") and "evaluations" not in (method_options or {}):
        method, method_options = "auto", {**(method_options or {}), "evaluations": whole}
    search = named_method(method, **(method_options or {})) if isinstance(method, str) else method

    stated = [_varied(parameters, each, model) for each in every]

    def searched(index: int, evaluations: int) -> Study:
        combination, where = every[index], place / str(index + 1)
        made, varied = stated[index]
        return optimize(
            made,
            varied,
            objective,
            search,
            folder=where,
            tolerance=without_fields(tolerance or {}, combination.values, model),
            budget=evaluations,
            resume=(where / SETTINGS).exists(),
            progress=progress,
            executor=executor,
            **problem,
        )

    # What could not be searched is tried again.
    if resume and len(ended := _read(place).get("tried") or ()) >= len(every):
        return _reopened(place, every, stated, objective, ended, rounds)
    left, spent, evaluated = list(range(len(every))), 0, 0
    tried: dict[int, Tried] = {}
    failed: dict[int, str] = {}
    for number, more in enumerate(share, start=1):
        spent += more
        for index in left:
            if (before := tried.pop(index, None)) is not None:
                before.study.close()
            try:
                tried[index] = Tried.of(every[index], searched(index, spent), number)
            except InputError as error:
                failed[index] = str(error)
                continue
            evaluated += tried[index].study.evaluated
        left = [index for index in left if index not in failed]
        if not left:
            index, why = next(iter(failed.items()))
            raise InputError(f"{every[index].name}: {why}")
        left.sort(key=lambda i: tried[i].rank)
        left = left[: (len(left) + 1) // 2]
    # What left early was worse with the same number of designs.
    order = sorted(tried, key=lambda i: (tried[i].standing, -tried[i].rounds, tried[i].rank))
    ordered = tuple(tried[index] for index in order)
    reasons = {every[index].name: why for index, why in failed.items()}
    found = Choices(ordered, rounds, None if kept is not None else place, evaluated, reasons, kept)
    if kept is None:
        if isfinite(ordered[0].value):
            best = found.best.best
            what = f"{called(best, found.robust)} of the choices, {found.combination.name}"
            save_design(place / OPTIMUM, best, what)
        _note_end(place, order, ordered)
    return found


def resume_choices(
    folder: str | Path,
    *,
    progress: StudyCallback | None = None,
    executor: AnyExecutor | None = None,
) -> Choices:
    """Go on with the choices in a folder, with their budget; see `choices`.

    InputError if the folder has none, or they were stated with objects, such as a user's function:
    call `choices` again, with ``resume=True``.
    """
    place = Path(folder)
    if not is_choices(place):
        raise InputError(f'"{place}" has no {FILE}: it holds no choices.')
    statement = _read(place)["statement"]
    if statement is None:
        raise InputError(
            f'the choices in "{place}" were stated with objects of Python: call '
            "flexor.study.choices again, with resume=True."
        )
    made = recorded_model(place)
    return choices(
        made, folder=place, resume=True, progress=progress, executor=executor, **statement
    )


def _read(place: Path) -> dict[str, Any]:
    try:
        read = json.loads((place / FILE).read_text(encoding="utf-8"))
        if read["format"] != _FORMAT or not isinstance(read["statement"], (dict, type(None))):
            raise ValueError
        return dict(read)
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError(f'"{place / FILE}" cannot be read: it is damaged.') from None


def _note_end(place: Path, order: Sequence[int], tried: Sequence[Tried]) -> None:
    """Write what was found, in the order of the combinations that are given by their numbers."""
    rows = [
        {
            "study": str(index + 1),
            "name": each.name,
            "rounds": each.rounds,
            "violation": each.violation if isfinite(each.value) else None,
            "value": each.value if isfinite(each.value) else None,
            "robust": each.robust,
        }
        for index, each in zip(order, tried, strict=True)
    ]
    write_text(place / FILE, json.dumps({**_read(place), "tried": rows}, indent=2))


def _reopened(
    place: Path,
    every: Sequence[Combination],
    stated: Sequence[tuple[Model, Any]],
    objective: Any,
    ended: Any,
    rounds: int,
) -> Choices:
    """Open what was found when all searches had ended."""
    tried = []
    try:
        rows = [
            (int(row["study"]), int(row["rounds"]), row["violation"], row["value"], row["robust"])
            for row in ended
        ]
        if sorted(row[0] for row in rows) != list(range(1, len(every) + 1)):
            raise ValueError
    except (ValueError, KeyError, TypeError):
        raise InputError(f'"{place / FILE}" cannot be read: it is damaged.') from None
    for number, count, violation, value, robust in rows:
        made, varied = stated[number - 1]
        named = varied if isinstance(varied, ParameterSet) else None
        wanted = None if isinstance(objective, str) else objective
        study = Study.open(place / str(number), model=made, parameters=named, objective=wanted)
        failed = value is None
        tried.append(
            Tried(
                every[number - 1],
                study,
                count,
                inf if failed else float(violation),
                inf if failed else float(value),
                robust,
            )
        )
    return Choices(tuple(tried), rounds, place)


def _varied(parameters: Any, combination: Combination, model: Model) -> tuple[Model, Any]:
    """Return the model of a combination and what varies in it, made once for all rounds."""
    made = combination.model
    if not isinstance(parameters, Mapping):
        return made, parameters
    try:
        fields = variables(without_fields(parameters, combination.values, model), made)
    except InputError as error:
        raise InputError(f"{combination.name}: {error}") from None
    return fields.prepared(made), fields


def _begin(place: Path, model: Model, statement: Mapping[str, Any]) -> None:
    if place.exists() and (not place.is_dir() or any(place.iterdir())):
        raise InputError(f'"{place}" is not an empty folder: choose another, or resume it.')
    place.mkdir(parents=True, exist_ok=True)
    for name, text in model_files(model).items():
        write_text(place / name, text)
    written = {"format": _FORMAT, "statement": _plain(statement)}
    write_text(place / FILE, json.dumps(written, indent=2))


def _plain(statement: Mapping[str, Any]) -> Any:
    """Return a statement as it is written; None if it has objects of Python."""
    try:
        return json.loads(json.dumps(statement))
    except TypeError:
        return None


def _check_same(place: Path, statement: Mapping[str, Any]) -> None:
    kept, given = _read(place)["statement"], _plain(statement)
    if kept is None or given is None:
        return  # the settings of each study are compared
    for key in {**kept, **given}:
        # What a search is given in addition may be left out where it is nothing.
        if (kept.get(key) or None) != (given.get(key) or None):
            raise InputError(
                f'the choices in "{place}" were made with another {key.replace("_", " ")}: resume '
                "them unchanged, or choose another folder."
            )
