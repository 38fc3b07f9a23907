"""Objectives: one number to minimise for the path of each design."""

from __future__ import annotations

from flexor.objective.base import Objective
from flexor.objective.bending import Bending
from flexor.objective.bending_contact import BendingContact, BendingContactPrinted
from flexor.objective.catalogue import names, objective
from flexor.objective.custom import custom
from flexor.objective.judge import Judgement, judge
from flexor.objective.paths import OnePath, PathArrays, PathGradient, Paths
from flexor.objective.tip_force import TipForce

__all__ = [
    "Bending",
    "BendingContact",
    "BendingContactPrinted",
    "Judgement",
    "Objective",
    "OnePath",
    "PathArrays",
    "PathGradient",
    "Paths",
    "TipForce",
    "custom",
    "judge",
    "names",
    "objective",
]
