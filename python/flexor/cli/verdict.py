"""Output of the verdict on a design: constraints, bounds, tolerances, mesh."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from flexor.cli.console import say
from flexor.cli.table import number, show, with_unit
from flexor.study.verdict import COARSE

if TYPE_CHECKING:
    from flexor.study import Design, Verdict
    from flexor.study.verdict import Within


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
        say('"broken": with that error a constraint is exceeded; state it as a --tolerance.')
    _print_within(found)
    for each in found.fragile:
        much = "makes it fail" if math.isnan(each.change) else f"by {100.0 * each.change:.0f} %"
        verb = "" if math.isnan(each.change) else f"moves {objective.quantity} "
        say(f"FRAGILE: 1 % of {each.name} {verb}{much}.")
    if found.snaps:
        say(f"FRAGILE: the optimum is reached through {found.snaps} snap(s).")
    if found.finer is not None:
        change = abs(found.finer - found.shown) / max(abs(found.shown), 1e-300)
        warning = "COARSE: " if not change <= COARSE else ""
        say(
            f"{warning}with twice the elements {objective.quantity} is "
            f"{with_unit(found.finer, objective.unit)}."
        )


def _print_within(found: Verdict) -> None:
    """Print the worst case within the tolerances: of what comes near a bound, and the objective."""
    if not found.within:
        return
    *constraints, objective = found.within
    broken = [each for each in constraints if not each.kept]
    if not broken:
        say("robust: all constraints hold for every error within the tolerances that was tried.")
    for each in broken:
        case = f" to {each.value}, {each.place}" if each.value else ""
        say(f"NOT ROBUST: errors within the tolerances break {each.what}{case}: {_cause(each)}.")
    for each in constraints:
        if each.near:
            case = f"{each.value}, {each.place}{_with(each)}"
            say(f"within the tolerances {each.what}: at worst {case}.")
    worst = objective.value or "none, as the design fails"
    say(f"within the tolerances {objective.what} is at worst {worst}{_with(objective)}.")


def _cause(each: Within) -> str:
    return f"{each.error}{f' in scenario {each.scenario}' if each.scenario else ''}"


def _with(each: Within) -> str:
    return f", with {_cause(each)}" if each.error or each.scenario else ""


def within_as_json(design: Design) -> list[dict[str, Any]]:
    """Return the worst case within the tolerances of each constraint and the objective."""
    return [asdict(each) for each in design.verdict.within]


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
