"""Constraints: bounds on observables along the whole path."""

from __future__ import annotations

from flexor.constraints.choice import (
    INFEASIBLE,
    chosen_constraints,
    excesses,
    ranks,
    violation,
    worst_values,
)
from flexor.constraints.constraint import Constraint, constraint
from flexor.constraints.defaults import default_constraints

__all__ = [
    "INFEASIBLE",
    "Constraint",
    "chosen_constraints",
    "constraint",
    "default_constraints",
    "excesses",
    "ranks",
    "violation",
    "worst_values",
]
