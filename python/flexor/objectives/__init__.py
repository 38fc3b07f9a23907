"""Objectives: one number to minimise for the path of each design."""

from __future__ import annotations

from flexor.objectives.base import Objective
from flexor.objectives.bending import Bending, BendingContact, BendingContactPrinted
from flexor.objectives.catalogue import names, needs_model, objective
from flexor.objectives.custom import custom
from flexor.objectives.evaluate import evaluate_objective
from flexor.objectives.extremum import Extremum, extremum
from flexor.objectives.gradient import PathGradient
from flexor.objectives.several import Several, several
from flexor.objectives.tip_force import TipForce

__all__ = [
    "Bending",
    "BendingContact",
    "BendingContactPrinted",
    "Extremum",
    "Objective",
    "PathGradient",
    "Several",
    "TipForce",
    "custom",
    "evaluate_objective",
    "extremum",
    "names",
    "needs_model",
    "objective",
    "several",
]
