"""Objectives: one number to minimise for the path of each design."""

from __future__ import annotations

from flexor.objectives.base import Objective
from flexor.objectives.bending import Bending
from flexor.objectives.bending_contact import BendingContact, BendingContactPrinted
from flexor.objectives.catalogue import names, objective
from flexor.objectives.custom import custom
from flexor.objectives.judge import Judgement, judge
from flexor.objectives.paths import OnePath, PathArrays, PathGradient, Paths
from flexor.objectives.tip_force import TipForce

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
