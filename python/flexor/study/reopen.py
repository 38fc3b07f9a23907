"""From a study folder back to its problem and its record."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from flexor.design import ParameterSet, parameter_set
from flexor.errors import InputError, shortened
from flexor.objectives import Objective
from flexor.objectives import objective as named_objective
from flexor.store import RECORD, Database, check_regular, open_record
from flexor.study.problem import Problem
from flexor.study.record import Record
from flexor.study.settings import MODEL, STUDY, Settings

if TYPE_CHECKING:
    from flexor.model import Model


def reopened(
    folder: Path,
    settings: Settings,
    model: Model | None = None,
    parameters: ParameterSet | None = None,
    objective: Objective | None = None,
) -> Problem:
    """Find the problem that a study's settings describe.

    Parameters
    ----------
    folder : Path
        The study folder, whose copy of the model is loaded.
    settings : Settings
        Its settings.
    model, parameters, objective : optional
        In place of those that the settings name.

    Raises
    ------
    InputError
        If the settings name something that is not known and was not given.
    """
    values = settings.values
    if model is None:
        from flexor.model import load

        check_regular(folder / MODEL)
        model = load(folder / MODEL)
    if parameters is None:
        try:
            parameters = parameter_set(values["parameters"]["name"], model.design)
        except InputError as error:
            raise _own("parameters", values["parameters"]["name"], folder) from error
        labels, lower, upper = (values["parameters"][key] for key in ("labels", "lower", "upper"))
        bounds = {label: (low, high) for label, low, high in zip(labels, lower, upper, strict=True)}
        parameters = parameters.with_bounds(bounds)
    if objective is None:
        try:
            objective = named_objective(values["objective"]["name"])
        except InputError as error:
            raise _own("objective", values["objective"]["name"], folder) from error
    return Problem(
        model,
        parameters.on(model.design),
        objective.at(values["objective"]["force"]),
        values["engine"],
    )


def reopened_record(
    folder: Path | None, problem: Problem, database: Database | None = None
) -> Record:
    """Open the record of a study folder, for reading unless a ``database`` is given.

    Raises
    ------
    InputError
        If it is missing, damaged or not of this problem's sizes.
    """
    if database is None:
        assert folder is not None
        database = open_record(STUDY, folder, write=False)
    record = Record(database)
    if record.sizes != problem.sizes:
        record.close()
        raise InputError(f'the study "{folder}" is damaged: its {RECORD} is of another study.')
    return record


def _own(kind: str, name: str, folder: Path) -> InputError:
    return InputError(
        f'the study "{folder}" uses {kind} "{shortened(name)}", which Flexor does not know: '
        f"give it as {kind}=."
    )
