"""Said before a search: what no variable has an effect on, and what no design seems to keep."""

from __future__ import annotations

import warnings
from collections.abc import Collection
from typing import Any

import numpy as np

from flexor.errors import InputError, ModelWarning
from flexor.model.results import Paths
from flexor.objectives import Extremum
from flexor.study.problem import FloatArray, Problem
from flexor.study.scenario_problem import ScenarioProblem

# Designs that are compared, besides the start.
_SAMPLES = 15
# A share of the value, or of a display unit, below which a change is one of rounding.
_ROUNDING = 1e-9


def check_problem(problem: Problem) -> None:
    """Try designs all over the bounds, and say what a search would not find.

    Refused is the extremum of an observable that no variable has an effect on: its values are the
    same, and all its derivatives vanish. Where these values are zero, such as that of an overlap
    without contact, or the objective is an aggregate of scenarios or errors, there is a warning, as
    they may differ elsewhere. Warnings are also of constraints that are far from being kept, and of
    those that all designs break alike under the first load.

    Raises
    ------
    InputError
        Naming the objective and the variables.
    """
    nominal = problem.nominal
    extremum = isinstance(nominal.objective, Extremum)
    if extremum or nominal.constraints:
        found = nominal.evaluate(_designs(nominal), gradient=extremum and nominal.differentiable)
        if extremum:
            _check_dependence(problem, found)
        _check_reach(nominal, found, _broken_at_first(nominal))


def _check_dependence(problem: Problem, found: Paths) -> None:
    """Refuse an objective that no variable has an effect on, or warn of it."""
    nominal = problem.nominal
    wanted = nominal.objective
    assert isinstance(wanted, Extremum)
    good = np.isfinite(found.value)
    values = found.value[good]
    if good.sum() < 3:
        return
    span = nominal.parameters.upper - nominal.parameters.lower
    changes = [np.ptp(values)]
    if nominal.differentiable:
        changes.append(np.abs(nominal.gradients(found)[good] * span).max())
    # Of a design whose derivatives are not known there are NaN, which are no zeros.
    if not max(changes) <= _ROUNDING * max(np.abs(values).max(), wanted.factor):
        return
    names = ", ".join(nominal.parameters.labels)
    value = f"{wanted.displayed(values[:1])[0]:.4g} {wanted.unit}".rstrip()
    if values.any() and not _aggregated(problem):
        raise InputError(
            f'objective "{wanted.name}" depends on none of the variables ({names}): it is {value} '
            f"for all of {len(values)} designs that were tried, and so are its derivatives zero."
        )
    warnings.warn(
        f'objective "{wanted.name}" is {value} for all of {len(values)} designs that were tried, '
        f"with derivatives of zero: it may depend on none of the variables ({names}).",
        ModelWarning,
        stacklevel=4,
    )


def _check_reach(nominal: Problem, found: Paths, said: Collection[str]) -> None:
    """Warn of constraints further from being kept than designs differ, but for those in `said`."""
    for each, column in zip(nominal.constraints, found.constraint_values.T, strict=True):
        text, values = each.text(nominal.model), column[np.isfinite(column)]
        if text in said or len(values) < 3:
            continue
        lowest, highest = float(values.min()), float(values.max())
        nearest = lowest if each.sense == "<=" else highest
        beyond = nearest - each.bound if each.sense == "<=" else each.bound - nearest
        if beyond > highest - lowest:
            shown = each.observable(nominal.model).shown
            warnings.warn(
                f'constraint "{text}" may never hold: {each.name} is from {shown(lowest)} to '
                f"{shown(highest)} for {len(values)} designs that were tried.",
                ModelWarning,
                stacklevel=4,
            )


def _broken_at_first(nominal: Problem) -> list[str]:
    """Warn of constraints that all designs break alike under the first load; return their texts.

    Such as of a bending that is zero there, where it was meant to be reached under the last load.
    """
    said: list[str] = []
    bounds = [each for each in nominal.constraints if not each.at_end]
    if not bounds or len(nominal.loads) < 2 or nominal.parameters.varied_inputs:
        return said
    model = nominal.model
    designs, valid = nominal.parameters.designs(_designs(nominal), model)
    if not valid.all():
        return said
    first = nominal.loads[:1]
    paths = model.evaluate(designs, first, **dict[str, Any](nominal.options))
    for each in bounds:
        values = each.worst(paths)[np.isfinite(paths.energy[:, 0])]
        size = max(np.abs(values).max(initial=0.0), each.observable(model).unit[0])
        if len(values) < 3 or not np.ptp(values) <= _ROUNDING * size:
            continue
        if (each.excess(values) > 0.0).all():
            said.append(each.text(model))
            warnings.warn(
                f'constraint "{each.text(model)}" is broken by all {len(values)} designs that were '
                f"tried under the first load, {model.show_loads(first[0])}, where {each.name} is "
                f'{each.observable(model).shown(float(values[0]))}: add "at end" if it has to hold '
                "at the last load only.",
                ModelWarning,
                stacklevel=4,
            )
    return said


def _aggregated(problem: Problem) -> bool:
    """Whether the objective is not that of the model as it is, without an error."""
    return isinstance(problem, ScenarioProblem) and (problem.named or bool(problem.errors.any()))


def _designs(problem: Problem) -> FloatArray:
    from scipy.stats import qmc  # deferred: slow to import

    chosen = problem.parameters
    unit = qmc.Sobol(chosen.size, scramble=True, seed=0).random(16)[:_SAMPLES]
    spread = chosen.lower + unit * (chosen.upper - chosen.lower)
    return np.concatenate([chosen.start[None, :], spread])
