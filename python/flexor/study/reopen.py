"""From the settings of a study back to its problem."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from flexor.design import ParameterSet, parameter_set
from flexor.errors import InputError, shortened
from flexor.objectives import Objective
from flexor.objectives import objective as named_objective
from flexor.study.folder import MODEL
from flexor.study.problem import Problem
from flexor.study.settings import Settings

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


def _own(kind: str, name: str, folder: Path) -> InputError:
    return InputError(
        f'the study "{folder}" uses {kind} "{shortened(name)}", which Flexor does not know: '
        f"give it as {kind}=."
    )
