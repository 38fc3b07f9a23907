"""Surveys: many designs or many searches at once, to see what a problem is like."""

from __future__ import annotations

from flexor.survey.comparison_result import MethodComparison, SearchRun, Summary
from flexor.survey.comparison_study import PAPER_SETS, compare, resume_comparison
from flexor.survey.comparison_work import ComparisonCallback, ComparisonProgress
from flexor.survey.landscape_result import Landscape
from flexor.survey.landscape_study import grid_over, landscape
from flexor.survey.profiles import Profile, data_profiles, performance_profiles
from flexor.survey.search_path import SearchPath

__all__ = [
    "PAPER_SETS",
    "ComparisonCallback",
    "ComparisonProgress",
    "Landscape",
    "MethodComparison",
    "Profile",
    "SearchPath",
    "SearchRun",
    "Summary",
    "compare",
    "data_profiles",
    "grid_over",
    "landscape",
    "performance_profiles",
    "resume_comparison",
]
