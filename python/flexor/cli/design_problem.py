"""A design problem stated on the command line, for all commands that take one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import typer

from flexor.arguments import assignments
from flexor.cli.console import note
from flexor.cli.values import lists, ranges
from flexor.errors import InputError

if TYPE_CHECKING:
    from flexor.design import Variables
    from flexor.model import Model


@dataclass(frozen=True)
class Statement:
    """What the options of a command state, completed by the ``[design]`` of the model file."""

    varied: Variables | None  # None if a parameter set varies
    bounds: Mapping[str, Sequence[object]]  # of what varies, by field
    aims: tuple[str, ...]  # objectives, such as ``"maximise bending"``
    subject_to: tuple[str, ...]
    without: tuple[str, ...]
    choices: Mapping[str, Sequence[object]]  # values among which others are chosen, by field

    @property
    def aim(self) -> str:
        """The objective; InputError if there are several."""
        if len(self.aims) > 1:
            raise InputError("give one of --maximise, --minimise and --objective.")
        return self.aims[0]


def stated(
    context: typer.Context,
    model: Model,
    objective: str,
    vary: Sequence[str] | None,
    maximise: Sequence[str] | None,
    minimise: Sequence[str] | None,
    subject_to: Sequence[str] | None,
    without: Sequence[str] | None,
    choose: Sequence[str] | None = None,
) -> Statement:
    """Read the statement of a design problem.

    Options replace what the model file states, a parameter set its variables; constraints add to
    those of the file, and replace one about the same observable.

    Parameters
    ----------
    context
        Of the command, whose parameter sets are its option `--parameters`.
    model
        The model.
    objective
        One of the paper's, if neither an observable nor the file says what is wanted.
    vary, maximise, minimise, subject_to, without, choose
        The options of these names; `choose` of commands that search.

    Raises
    ------
    InputError
        If two options exclude each other, or a field or bound is wrong.
    """
    from flexor.constraints import joined_constraints
    from flexor.design import variables
    from flexor.model.schema import Design

    there = model.file.design or Design.model_construct()
    by_set, by_name = (is_given(context, name) for name in ("parameters", "objective"))
    if vary and by_set:
        raise InputError("--vary and --parameters are two statements of what varies: give one.")
    aims = [f"maximise {name}" for name in maximise or []]
    aims += [f"minimise {name}" for name in minimise or []]
    if aims and by_name:
        raise InputError("give one of --maximise, --minimise and --objective.")
    if not aims:
        aims = [objective] if by_name else list(there.aims) or [objective]
    bounds = dict(ranges("--vary", list(vary or []))) or ({} if by_set else there.varied)
    source = "--vary" if vary else f"{model.name}: design.variable"
    return Statement(
        varied=variables(bounds, model, source) if bounds else None,
        bounds=bounds,
        aims=tuple(aims),
        subject_to=joined_constraints(there.subject_to, subject_to or (), model),
        without=tuple(without or there.without),
        choices=lists("--choose", list(choose or [])) or ({} if by_set or vary else there.choices),
    )


def uncertainty(
    model: Model,
    problem: Statement,
    scenarios: str | None,
    aggregate: str | None,
    tolerance: Sequence[str] | None,
    samples: int | None,
    wearers: int | None,
    *,
    for_sizes: bool = False,
) -> dict[str, Any]:
    """Return scenarios and tolerances as `flexor.optimize` takes them.

    What the file states holds for problems such as its own: one observable, over fields.
    """
    from flexor.model.schema import Design
    from flexor.objectives import needs_model

    there = Design.model_construct()
    if problem.varied is not None and len(problem.aims) == 1 and needs_model(problem.aim):
        there = model.file.design or there
    given = assignments("--tolerance", list(tolerance or []), "exosuit.section.wall=0.1 mm")
    how, count = aggregate or there.aggregate, there.samples if samples is None else samples
    stated = given or there.tolerance
    if how.strip().startswith("served") and not given and not count:
        if not for_sizes:
            say_unapplied(model, "the share that is served without --samples")
        stated = {}
    return {
        "scenarios": scenarios or there.scenarios,
        "aggregate": how,
        "tolerance": stated,
        "samples": count,
        "wearers": wearers or 0,
    }


def say_unapplied(model: Model, what: str) -> None:
    """Say that errors which the file states are not applied to a kind of result."""
    there = model.file.design
    if there is not None and there.tolerance:
        note(f'The tolerances that "{model.name}" states are not applied to {what}.')


def is_given(context: typer.Context, name: str) -> bool:
    """Return whether an option was given on the command line."""
    source = context.get_parameter_source(name)
    return source is not None and source.name != "DEFAULT"
