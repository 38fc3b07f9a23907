"""Said before a search: what no variable has an effect on, and what no design keeps at first."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from flexor.errors import InputError, ModelWarning
from flexor.objectives import Extremum
from flexor.study.problem import FloatArray, Problem
from flexor.study.scenario_problem import ScenarioProblem

# Designs that are compared, besides the start.
_SAMPLES = 15
# A share of the value, or of a display unit, below which a change is one of rounding.
_ROUNDING = 1e-9


def check_dependence(problem: Problem) -> None:
    """Refuse to search for the extremum of an observable that no variable has an effect on.

    That is so if its values at designs all over the bounds are the same, and all its derivatives
    there vanish. Where these values are zero, such as that of an overlap without contact, or the
    objective is an aggregate of scenarios or errors, there is a warning, as they may differ
    elsewhere.

    Raises
    ------
    InputError
        Naming the objective and the variables.
    """
    nominal = problem.nominal
    wanted = nominal.objective
    if not isinstance(wanted, Extremum):
        return
    found = nominal.evaluate(_designs(nominal), gradient=nominal.differentiable)
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
        stacklevel=3,
    )


def check_first_load(problem: Problem) -> None:
    """Warn of constraints that all designs break alike under the first load.

    Such as of a bending that is zero there, where it was meant to be reached under the last load.
    """
    nominal = problem.nominal
    bounds = [each for each in nominal.constraints if not each.at_end]
    if not bounds or len(nominal.loads) < 2 or nominal.parameters.varied_inputs:
        return
    model = nominal.model
    designs, valid = nominal.parameters.designs(_designs(nominal), model)
    if not valid.all():
        return
    first = nominal.loads[:1]
    paths = model.evaluate(designs, first, **dict[str, Any](nominal.options))
    for each in bounds:
        values = each.worst(paths)[np.isfinite(paths.energy[:, 0])]
        size = max(np.abs(values).max(initial=0.0), each.observable(model).unit[0])
        if len(values) < 3 or not np.ptp(values) <= _ROUNDING * size:
            continue
        if (each.excess(values) > 0.0).all():
            warnings.warn(
                f'constraint "{each.text(model)}" is broken by all {len(values)} designs that were '
                f"tried under the first load, {model.show_loads(first[0])}, where {each.name} is "
                f'{each.observable(model).shown(float(values[0]))}: add "at end" if it has to hold '
                "at the last load only.",
                ModelWarning,
                stacklevel=3,
            )


def _aggregated(problem: Problem) -> bool:
    """Whether the objective is not that of the model as it is, without an error."""
    return isinstance(problem, ScenarioProblem) and (problem.named or bool(problem.errors.any()))


def _designs(problem: Problem) -> FloatArray:
    from scipy.stats import qmc  # deferred: slow to import

    chosen = problem.parameters
    unit = qmc.Sobol(chosen.size, scramble=True, seed=0).random(16)[:_SAMPLES]
    spread = chosen.lower + unit * (chosen.upper - chosen.lower)
    return np.concatenate([chosen.start[None, :], spread])
