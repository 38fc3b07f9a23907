"""What is said of a design: the same sentences in the terminal and on pages."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from flexor.observables.snap_margin import REACH
from flexor.study.scenario_problem import ScenarioProblem
from flexor.study.verdict import COARSE

# Mean pressure in the arterial limb of capillaries at the nail fold of fingers, 37.7 mmHg (Williams
# et al. 1988) [Pa]. Pressure on the skin above it may stop the blood there while it lasts.
CAPILLARY = 5.03e3

if TYPE_CHECKING:
    from flexor.study.design import Design
    from flexor.study.problem import Problem
    from flexor.study.verdict import Verdict


def headline(found: Verdict) -> str:
    """Return whether the best design keeps its constraints; empty if there are none."""
    if not found.feasible:
        broken = [each.text for each in found.constraints if each.state == "BROKEN"]
        return f"NOT FEASIBLE: no design that was tried keeps {' and '.join(broken)}."
    if any(each.excess > 0.0 for each in found.constraints):
        return (
            "Constraints have to hold for those who are served: what is worst below is that of all."
        )
    if not found.robust:
        return (
            "NOT ROBUST: the best design found keeps all constraints as drawn, but not for every "
            "error within the tolerances."
        )
    if found.constraints and found.within:
        return "feasible: the optimum keeps all constraints, also within the tolerances."
    return "feasible: the optimum keeps all constraints." if found.constraints else ""


def cautions(design: Design) -> list[str]:
    """Return how far to trust a design: its margin for errors, what is fragile, and its mesh.

    And what has no effect on it, and how it presses on the skin.
    """
    found = design.verdict
    return [
        *without_effect(found.ineffective),
        *_margins(found),
        *_fragilities(design),
        *_mesh(design),
        *_on_skin(found),
    ]


def without_effect(labels: Sequence[str]) -> Iterator[str]:
    """Yield which variables have no effect on the objective and the constraints."""
    if labels:
        have = "has" if len(labels) == 1 else "have"
        yield (
            f"{enumerated(labels)} {have} no effect on what is sought and the constraints, from "
            "bound to bound where that was tried: any value does."
        )


def title(found: Verdict) -> str:
    """Return what the best design of a study is called."""
    if not found.feasible:
        return "least infeasible design"
    return "optimum" if found.robust else "best design found"


def of_model(problem: Problem) -> str:
    """Return the quantity of the objective, with what it is of where that is not all scenarios."""
    several = isinstance(problem, ScenarioProblem) and problem.named
    return f"{problem.objective.quantity}{' of the model as it is' if several else ''}"


def enumerated(names: Sequence[str]) -> str:
    """Return names as a sentence has them, such as ``"a, b and c"``."""
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def with_unit(value: float, unit: str) -> str:
    """Return a number with its unit, which may be empty."""
    text = f"{value:.4g}"
    return f"{'0' if float(text) == 0.0 else text} {unit}".rstrip()


def _margins(found: Verdict) -> Iterator[str]:
    """Yield the worst cases within the tolerances: of what comes near a bound, and the objective.

    Of an infeasible design errors say nothing more.
    """
    if not found.within or not found.feasible:
        return
    *constraints, objective = found.within
    if found.robust:
        yield "robust: all constraints hold for every error within the tolerances that was tried."
    for each in constraints:
        scenario = f", in scenario {each.scenario}" if each.scenario else ""
        case = f"{each.value}, {each.place}{scenario}" if each.value else f"no value{scenario}"
        if not each.kept:
            yield f"NOT ROBUST: errors within the tolerances break {each.what}: {case}."
        elif each.near:
            yield f"within the tolerances {each.what}: at worst {case}."
    worst = objective.value or "none, as the design fails"
    scenario = f", in scenario {objective.scenario}" if objective.scenario else ""
    yield f"within the tolerances {objective.what} is at worst {worst}{scenario}."


def _fragilities(design: Design) -> Iterator[str]:
    found, quantity = design.verdict, of_model(design.problem)
    for each in found.fragile:
        if math.isnan(each.change):
            yield f"FRAGILE: 1 % of {each.name} makes it fail."
        else:
            much = f"{100.0 * each.change:.0f} %"
            yield f"FRAGILE: 1 % of {each.name} moves {quantity} by {much}."
    for kind, count in (("snap", found.snaps), ("bifurcation", found.bifurcations)):
        if count:
            several = f"a {kind}" if count == 1 else f"{count} {kind}s"
            yield f"FRAGILE: the design is reached through {several}."
    if found.snap_margin is not None and math.isfinite(found.snap_margin):
        beyond = found.snap_margin < REACH - 1.0
        where = f"{found.snap_margin:.0%} beyond" if beyond else f"none up to {REACH:g} times"
        yield f"The next snap: {where} the last load."


def _on_skin(found: Verdict) -> Iterator[str]:
    """Yield the largest contact pressure beside that of the blood in the skin of a finger."""
    if found.pressure is None or found.pressure[0] <= 0.0:
        return
    value, place = found.pressure
    blood = f"blood pressure in the skin of a finger, {CAPILLARY / 1e3:.2g} kPa (williams1988)"
    what = f"the largest contact pressure is {value / 1e3:.3g} kPa ({place})"
    times = f"{value / CAPILLARY:.2g} times the {blood}: under the load blood may not flow there"
    yield f"{what}, {times if value > CAPILLARY else f'below the {blood}'}."


def _mesh(design: Design) -> Iterator[str]:
    found, unit = design.verdict, design.problem.objective.unit
    if found.finer is None:
        return
    change = abs(found.finer - found.shown) / max(abs(found.shown), 1e-300)
    coarse = "" if change <= COARSE else "COARSE: "
    yield (
        f"{coarse}with twice the elements: {of_model(design.problem)} "
        f"{with_unit(found.finer, unit)} instead of {with_unit(found.shown, unit)}."
    )
