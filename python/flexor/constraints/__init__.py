"""Constraints: bounds on observables along the whole path."""

from __future__ import annotations

from flexor.constraints.choice import (
    INFEASIBLE,
    chosen_constraints,
    excesses,
    feasible_parts,
    joined_constraints,
    ranks,
    violation,
    worst_values,
)
from flexor.constraints.constraint import Constraint, constraint
from flexor.constraints.defaults import default_constraints
from flexor.constraints.possible import check_possible

__all__ = [
    "INFEASIBLE",
    "Constraint",
    "check_possible",
    "chosen_constraints",
    "constraint",
    "default_constraints",
    "excesses",
    "feasible_parts",
    "joined_constraints",
    "ranks",
    "violation",
    "worst_values",
]
