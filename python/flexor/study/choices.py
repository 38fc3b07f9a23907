"""Discrete choices: a search for each combination, with a shared budget."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf, isfinite
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexor.arguments import integer
from flexor.design import variables
from flexor.design.choices import Combination, combinations, without_fields
from flexor.errors import InputError
from flexor.model.loading import require_model
from flexor.optimizers import Search
from flexor.optimizers import method as named_method
from flexor.store import SETTINGS, check_regular, write_text
from flexor.study.executors import AnyExecutor
from flexor.study.optimization import optimize
from flexor.study.settings import model_files, recorded_model
from flexor.study.study import Study, StudyCallback

if TYPE_CHECKING:
    from flexor.model import Model

# Designs that all combinations have together.
BUDGET = 3000
FILE, BEST = "choices.json", "best.toml"
_FORMAT = 1


@dataclass(frozen=True, eq=False)
class Tried:
    """A combination and what the search for it found."""

    combination: Combination
    study: Study
    rounds: int  # of all, in which it took part

    @property
    def name(self) -> str:
        """Name of the combination."""
        return self.combination.name

    @property
    def rank(self) -> tuple[float, float]:
        """Violation and value of its best design, by which combinations are ordered."""
        assert self.study.result is not None
        # Not the best that is recorded: work that is resumed has gone on further.
        found = self.study.record.outcomes(self.study.result.design)
        failed = not isfinite(found.value[0])
        return (inf, inf) if failed else (float(found.violation[0]), float(found.value[0]))


@dataclass(frozen=True, eq=False)
class Choices:
    """The best of all combinations of choices; made by `choices`."""

    tried: tuple[Tried, ...]  # the best first, and last what left first
    rounds: int
    folder: Path | None
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
        Go on with the work in the folder, which has to be of the same statement.
    progress, executor
        As for `flexor.optimize`.
    **problem
        Other options of `flexor.optimize` that state the problem, such as ``subject_to``.

    Raises
    ------
    InputError
        As `flexor.optimize` and `flexor.design.combinations`.
    """
    model = require_model(model)
    every = combinations(given, model)
    total = integer("budget", BUDGET if budget is None else budget, 1)
    rounds = (len(every) - 1).bit_length() + 1
    kept: tempfile.TemporaryDirectory[str] | None = None
    if folder is None:
        if resume:
            raise InputError("resuming choices needs their folder.")
        kept = tempfile.TemporaryDirectory(prefix="flexor-")
    place = Path(kept.name if kept is not None else str(folder))
    if kept is None and not resume:
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
        run = partial(optimize, made, varied, objective, search, folder=where)
        try:
            return run(
                tolerance=without_fields(tolerance or {}, combination.values, model),
                budget=evaluations,
                resume=(where / SETTINGS).exists(),
                progress=progress,
                executor=executor,
                **problem,
            )
        except InputError as error:
            raise InputError(f"{combination.name}: {error}") from None

    left, spent = list(range(len(every))), 0
    tried: dict[int, Tried] = {}
    for number, more in enumerate(share, start=1):
        spent += more
        for index in left:
            if index in tried:
                tried[index].study.close()
            tried[index] = Tried(every[index], searched(index, spent), number)
        left.sort(key=lambda i: tried[i].rank)
        left = left[: (len(left) + 1) // 2]
    # What left early was worse with the same number of designs.
    ordered = tuple(sorted(tried.values(), key=lambda each: (-each.rounds, each.rank)))
    found = Choices(ordered, rounds, None if kept is not None else place, kept)
    if kept is None and isfinite(found.tried[0].rank[1]):
        write_text(place / BEST, found.best.best.model.to_toml())
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
    try:
        read = json.loads((place / FILE).read_text(encoding="utf-8"))
        if read["format"] != _FORMAT:
            raise ValueError
        statement = dict(read["statement"] or {})
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError(f'"{place / FILE}" cannot be read: it is damaged.') from None
    if not statement:
        raise InputError(
            f'the choices in "{place}" were stated with objects of Python: call '
            "flexor.study.choices again, with resume=True."
        )
    made = recorded_model(place)
    return choices(
        made, folder=place, resume=True, progress=progress, executor=executor, **statement
    )


def is_choices(folder: Path) -> bool:
    """Return whether a folder holds choices."""
    return check_regular(folder / FILE)


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
    try:
        plain = json.loads(json.dumps(statement))
    except TypeError:
        plain = None
    write_text(place / FILE, json.dumps({"format": _FORMAT, "statement": plain}, indent=2))
