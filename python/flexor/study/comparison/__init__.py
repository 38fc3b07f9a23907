"""Comparisons of search methods from the same starts, seeds and budget."""

from __future__ import annotations

from flexor.study.comparison.profiles import Profile, data_profiles, performance_profiles
from flexor.study.comparison.result import MethodComparison, SearchRun, Summary
from flexor.study.comparison.run import (
    BUILT_IN_SETS,
    compare,
    open_comparison,
    resume_comparison,
)
from flexor.study.comparison.work import ComparisonCallback, ComparisonProgress

__all__ = [
    "BUILT_IN_SETS",
    "ComparisonCallback",
    "ComparisonProgress",
    "MethodComparison",
    "Profile",
    "SearchRun",
    "Summary",
    "compare",
    "data_profiles",
    "open_comparison",
    "performance_profiles",
    "resume_comparison",
]
