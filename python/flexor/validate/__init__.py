"""Validation against independent truth: closed forms, other libraries, the paper's toolbox.

`cases` lists the cases, `run` runs one, `write` writes the report. No reference value is produced
by Flexor's own code.
"""

from __future__ import annotations

from flexor.validate.case import CLOSED_FORM, CONVERGENCE, OTHER_LIBRARY, TOOLBOX, Case, Outcome
from flexor.validate.catalogue import cases, chosen
from flexor.validate.comparison import Comparison
from flexor.validate.report import write
from flexor.validate.running import Result, run

__all__ = [
    "CLOSED_FORM",
    "CONVERGENCE",
    "OTHER_LIBRARY",
    "TOOLBOX",
    "Case",
    "Comparison",
    "Outcome",
    "Result",
    "cases",
    "chosen",
    "run",
    "write",
]
