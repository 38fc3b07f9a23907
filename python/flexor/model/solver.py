"""Options of the engine's solver, checked against the ranges that the engine declares."""

from __future__ import annotations

import os
from collections.abc import Mapping

import numpy as np

from flexor._engine import SOLVER_OPTIONS
from flexor.errors import InputError, unknown
from flexor.model.validation import describe

# More threads than cores only use more memory.
_MOST_THREADS = 64


def solver_options(options: Mapping[str, float]) -> dict[str, float]:
    """Check options of the solver."""
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


def useful_threads(threads: int) -> int:
    """Return a number of threads for the engine, capped at a useful maximum."""
    if isinstance(threads, bool) or not isinstance(threads, (int, np.integer)) or threads < 0:
        raise InputError(
            f"threads is {describe(threads)}: expected an integer, 0 for one per core or more."
        )
    return min(int(threads), max(_MOST_THREADS, os.cpu_count() or 1))
