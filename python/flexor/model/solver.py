"""Settings of the engine's solver, checked."""

from __future__ import annotations

import math
from collections.abc import Mapping

from flexor.errors import InputError, unknown
from flexor.model.validation import describe

_NAMES = ("tolerance", "max_iterations", "min_step")


def solver_options(options: Mapping[str, float]) -> dict[str, float]:
    """Check settings of the solver.

    Parameters
    ----------
    options
        ``tolerance`` (of the scaled, dimensionless residual), ``max_iterations`` (Newton iterations
        of one load step) and ``min_step`` (smallest part of a load step before a branch counts as
        ended); what is left out is the engine's own.

    Returns
    -------
    dict
        The same, as the engine takes them.

    Raises
    ------
    InputError
        If one is not known or not in its range.
    """
    checked: dict[str, float] = {}
    for name, value in options.items():
        if name not in _NAMES:
            raise unknown("solver option", name, _NAMES)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise InputError(f"solver option {name} is {describe(value)}: expected a number.")
        if name == "max_iterations":
            if not 1 <= value <= 10**9 or value != int(value):
                raise InputError(
                    f"solver option {name} is {describe(value)}: a whole number from 1 is needed."
                )
            checked[name] = int(value)
            continue
        if not 0.0 < value <= 1.0 or not math.isfinite(value):
            raise InputError(
                f"solver option {name} is {describe(value)}: it must be above 0 and at most 1."
            )
        checked[name] = float(value)
    return checked
