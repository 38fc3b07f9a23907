"""Output of the verdict on a design: constraints, bounds, tolerances, mesh."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from flexor.cli.console import say
from flexor.cli.table import number, show, with_unit
from flexor.observables.snap_margin import REACH
from flexor.study.verdict import COARSE

if TYPE_CHECKING:
    from flexor.study import Design


def print_verdict(design: Design) -> None:
    """Print whether a design keeps its constraints, each with its value and place."""
    found = design.verdict
    if not found.feasible:
        broken = [each.text for each in found.constraints if each.state == "BROKEN"]
        say(f"NOT FEASIBLE: no design that was tried keeps {' and '.join(broken)}.")
    elif found.constraints:
        say("feasible: the optimum keeps all constraints.")
    if found.constraints:
        rows = [(each.text, each.value, each.state, each.place) for each in found.constraints]
        show(("constraint", "worst", "", "where"), rows)
    for bound in found.bounds:
        say(f"{bound}, binds.")


def print_tolerances(design: Design) -> None:
    """Print what manufacturing errors and a finer mesh do to a design."""
    found, objective = design.verdict, design.problem.objective
    rows = []
    for k, (label, step) in enumerate(
        zip(design.problem.parameters.labels, found.steps, strict=True)
    ):
        cells = [
            "fails" if math.isnan(value) else number(value) + (" (broken)" if out > 0.0 else "")
            for value, out in zip(found.off[k].tolist(), found.broken[k].tolist(), strict=True)
        ]
        rows.append((f"{label} ± {step}", *cells))
    unit = f" / {objective.unit}" if objective.unit else ""
    show((f"{objective.quantity}{unit}", "if less", "if more"), rows)
    if found.worst is not None:
        label, step = design.problem.parameters.labels[found.worst], found.steps[found.worst]
        say(f"An error of {step} in {label} matters most.")
    if found.broken.max(initial=0.0) > 0.0 and found.feasible:
        say('"broken": with that error a constraint is exceeded; ask for a margin.')
    for label in found.fragile:
        say(f"FRAGILE: 1 % of {label} moves {objective.quantity} by more than a tenth.")
    if found.snaps:
        say(f"FRAGILE: the optimum is reached through {found.snaps} snap(s).")
    if found.snap_margin is not None and math.isfinite(found.snap_margin):
        beyond = found.snap_margin < REACH - 1.0
        where = f"{found.snap_margin:.0%} beyond" if beyond else f"none up to {REACH:g} times"
        say(f"The next snap: {where} the last load.")
    if found.finer is not None:
        change = abs(found.finer - found.shown) / max(abs(found.shown), 1e-300)
        warning = "COARSE: " if not change <= COARSE else ""
        say(
            f"{warning}with twice the elements {objective.quantity} is "
            f"{with_unit(found.finer, objective.unit)}."
        )


def constraints_as_json(design: Design) -> list[dict[str, Any]]:
    """Return the constraints of a design: worst values along the path, SI."""
    problem = design.problem
    values = problem.worst_of(design.constraint_values)
    excess = problem.worst_excesses(design.constraint_values)
    return [
        {
            "constraint": each.text(problem.model),
            "default": each.default or None,
            "value": float(value) if math.isfinite(value) else None,
            "kept": bool(over <= 0.0),
        }
        for each, value, over in zip(problem.constraints, values, excess, strict=True)
    ]
