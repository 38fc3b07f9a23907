"""Output of the verdict on a design: constraints, bounds, tolerances, mesh."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from flexor.cli.console import say
from flexor.cli.table import number, show
from flexor.study.sentences import cautions, enumerated, headline, of_model

if TYPE_CHECKING:
    from flexor.study import Design, Verdict
    from flexor.study.verdict import Kept


def print_verdict(design: Design) -> None:
    """Print whether a design keeps its constraints, each with its value and place."""
    found = design.verdict
    if text := headline(found):
        say(text)
    print_constraints(found.constraints, found.bounds)


def print_constraints(constraints: Sequence[Kept], bounds: Iterable[str] = ()) -> None:
    """Print the worst value of each constraint, and the bounds that bind."""
    if constraints:
        rows = [(each.text, each.value, each.state, each.place) for each in constraints]
        show(("constraint", "worst", "", "where"), rows)
    for bound in bounds:
        say(f"{bound}, binds.")


def print_tolerances(design: Design) -> None:
    """Print what manufacturing errors and a finer mesh do to a design."""
    found, objective = design.verdict, design.problem.objective
    labels, feasible = design.problem.parameters.labels, found.feasible
    rows, mark = [], " (broken)" if feasible else ""
    for k, (label, step) in enumerate(zip(labels, found.steps, strict=True)):
        less, more = (
            "fails" if math.isnan(value) else number(value) + (mark if out > 0.0 else "")
            for value, out in zip(found.off[k].tolist(), found.broken[k].tolist(), strict=True)
        )
        rows.append((f"{label} ± {step}", less, number(found.shown), more))
    unit = f" / {objective.unit}" if objective.unit else ""
    heading = f"{of_model(design.problem)}{unit}"
    show((heading, "if less", "as drawn", "if more"), rows)
    if found.worst is not None:
        # Tolerances may be of fields that do not vary; what they do is in the margins.
        others = any(each.partition(" ±")[0] not in labels for each in found.tolerances)
        among = "Of the variables, an error" if others else "An error"
        say(f"{among} of {found.steps[found.worst]} in {labels[found.worst]} matters most.")
    unstated = [
        label
        for label, stated, out in zip(labels, found.stated, found.broken, strict=True)
        if not stated and out.max() > 0.0
    ]
    if feasible and unstated:
        say(
            '"broken": with that error a constraint is exceeded; state the error of '
            f"{enumerated(unstated)} as a --tolerance to leave a margin."
        )
    for text in cautions(design):
        say(text)
    for text in found.warnings:
        say(f"warning: {text}")
    _print_errors(found)


def _print_errors(found: Verdict) -> None:
    """Print which errors within the tolerances are worst, of what is broken or nearly so."""
    if not found.within or not found.feasible:
        return
    *constraints, objective = found.within
    chosen = [each for each in constraints if each.near or not each.kept]
    columns = [each for each in (*chosen, objective) if any(each.signs)]
    rows = [
        (label, *(each.signs[i] for each in columns)) for i, label in enumerate(found.tolerances)
    ]
    if columns:
        show(("worst errors of", *(each.what for each in columns)), rows)


def within_as_json(design: Design) -> list[dict[str, Any]]:
    """Return the worst case within the tolerances of each constraint and the objective."""
    return [asdict(each) for each in design.verdict.within]


def warnings_of(design: Design) -> list[str]:
    """Return the warnings of the model with a design."""
    return list(design.verdict.warnings)


def constraints_as_json(design: Design) -> list[dict[str, Any]]:
    """Return the constraints of a design as drawn: worst values along the path, SI."""
    return [
        {
            "constraint": each.text,
            "default": each.default or None,
            "value": each.number if math.isfinite(each.number) else None,
            "kept": each.excess <= 0.0,
        }
        for each in design.kept
    ]
