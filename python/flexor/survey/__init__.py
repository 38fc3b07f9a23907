"""Surveys: many designs or many searches at once, to see what a problem is like."""

from __future__ import annotations

from flexor.survey.landscape_result import Landscape
from flexor.survey.landscape_study import grid_over, landscape
from flexor.survey.search_path import SearchPath

__all__ = ["Landscape", "SearchPath", "grid_over", "landscape"]
