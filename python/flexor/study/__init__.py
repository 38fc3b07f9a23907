"""Studies: run, record, resume."""

from __future__ import annotations

from flexor.study.choices import Choices, choices, resume_choices
from flexor.study.design import Design
from flexor.study.executors import (
    AnyExecutor,
    Cluster,
    DesignEvaluator,
    Pool,
    Threads,
    chosen_executor,
)
from flexor.study.front import Front
from flexor.study.function import ObjectiveFunction, ObjectiveGradients, objective_function
from flexor.study.members import has_members, is_choices, member
from flexor.study.optimization import optimize, resume
from flexor.study.problem import Problem
from flexor.study.record import Record
from flexor.study.recorded_evaluator import RecordedEvaluator
from flexor.study.rerun import Changed, Difference, Rerun, rerun
from flexor.study.scenario_problem import ScenarioProblem, Uncertainty
from flexor.study.sensitivity import Sensitivity
from flexor.study.settings import Settings
from flexor.study.sizes import Sizes, sizes
from flexor.study.study import Comparison, Study, StudyCallback, StudyProgress
from flexor.study.verdict import Kept, Verdict

__all__ = [
    "AnyExecutor",
    "Changed",
    "Choices",
    "Cluster",
    "Comparison",
    "Design",
    "DesignEvaluator",
    "Difference",
    "Front",
    "Kept",
    "ObjectiveFunction",
    "ObjectiveGradients",
    "Pool",
    "Problem",
    "Record",
    "RecordedEvaluator",
    "Rerun",
    "ScenarioProblem",
    "Sensitivity",
    "Settings",
    "Sizes",
    "Study",
    "StudyCallback",
    "StudyProgress",
    "Threads",
    "Uncertainty",
    "Verdict",
    "choices",
    "chosen_executor",
    "has_members",
    "is_choices",
    "member",
    "objective_function",
    "optimize",
    "rerun",
    "resume",
    "resume_choices",
    "sizes",
]
