"""Options of the engine's solver, checked against what the engine says of them."""

from __future__ import annotations

from collections.abc import Mapping

from flexor._engine import SOLVER_OPTIONS
from flexor.errors import InputError, unknown
from flexor.model.validation import describe


def solver_options(options: Mapping[str, float]) -> dict[str, float]:
    """Check options of the solver.

    Parameters
    ----------
    options
        By name, as in `flexor._engine.SOLVER_OPTIONS`, which has their defaults, ranges and
        meaning; what is left out has its default.

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
        if name not in SOLVER_OPTIONS:
            raise unknown("solver option", name, SOLVER_OPTIONS)
        known = SOLVER_OPTIONS[name]
        found = f"solver option {name} is {describe(value)}"
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise InputError(f"{found}: expected a number.")
        low, high, exclusive = known["minimum"], known["maximum"], known["exclusive"]
        inside = (low < value if exclusive else low <= value) and value <= high
        if known["integer"] and not (inside and value == int(value)):
            raise InputError(f"{found}: expected an integer from {low:g}.")
        if not inside:
            start = f"above {low:g}" if exclusive else f"at least {low:g}"
            raise InputError(f"{found}: it must be {start} and at most {high:g}.")
        checked[name] = int(value) if known["integer"] else float(value)
    return checked
