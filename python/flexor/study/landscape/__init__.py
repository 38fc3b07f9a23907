"""Landscapes: an objective on a grid over one or two parameters."""

from __future__ import annotations

from flexor.study.landscape.evaluate import grid_over, landscape
from flexor.study.landscape.result import Landscape
from flexor.study.landscape.search_path import SearchPath

__all__ = ["Landscape", "SearchPath", "grid_over", "landscape"]
