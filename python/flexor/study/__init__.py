"""Studies: run, record, resume."""

from __future__ import annotations

from flexor.study.design import Design
from flexor.study.executor import Executor, Threads
from flexor.study.optimization import optimize, resume
from flexor.study.outcomes import Outcomes
from flexor.study.problem import Problem
from flexor.study.progress import StudyCallback, StudyProgress
from flexor.study.record import Record
from flexor.study.recorded import Recorded
from flexor.study.run import run
from flexor.study.settings import Settings
from flexor.study.study import Comparison, Study

__all__ = [
    "Comparison",
    "Design",
    "Executor",
    "Outcomes",
    "Problem",
    "Record",
    "Recorded",
    "Settings",
    "Study",
    "StudyCallback",
    "StudyProgress",
    "Threads",
    "optimize",
    "resume",
    "run",
]
