"""Constraints that no design can keep, found before anything is evaluated."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from flexor.arrays import Array
from flexor.constraints.constraint import Constraint
from flexor.errors import InputError
from flexor.model.structure import Structure

RANGE = "range-of-motion"  # which is counted from the first load


def check_possible(
    constraints: Sequence[Constraint], model: Structure, loads: Array, varied: Collection[str] = ()
) -> None:
    """Raise InputError if a constraint can never hold.

    Parameters
    ----------
    constraints
        Those of a problem.
    model
        The model.
    loads : (steps, inputs) array
        Loads of its paths.
    varied
        Inputs whose loads depend on the design.
    """
    for each in constraints:
        found = each.observable(model)
        text = f'constraint "{each.text(model)}" can never hold'
        if each.sense == "<=" and found.lowest is not None and each.bound < found.lowest:
            raise InputError(f"{text}: {each.name} is never below {found.shown(found.lowest)}.")
        if each.name == RANGE and not each.at_end and float(each.excess(np.zeros(1))[0]) > 0.0:
            raise InputError(
                f"{text}: under the first load {each.name} is {found.shown(0.0)}; add "
                '"at end" if it has to hold at the last load only.'
            )
        kind, _, name = each.name.partition(".")
        free = kind == "pressure" and name not in model.controlled
        if free and model.driven_by[name] not in varied:
            column = loads[-1 if each.at_end else 0 :, model.input_of(name)]
            worst = float(column.max() if each.sense == "<=" else column.min())
            if float(each.excess(np.array([worst]))[0]) > 0.0:
                raise InputError(f"{text}: the loads go to {found.shown(worst)} for every design.")
    for upper in (each for each in constraints if each.sense == "<="):
        for lower in (each for each in constraints if each.sense == ">="):
            if lower.name == upper.name and lower.bound > upper.bound:
                raise InputError(
                    f'constraints "{lower.text(model)}" and "{upper.text(model)}" can never hold '
                    "both: make their bounds agree."
                )
