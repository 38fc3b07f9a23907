"""Landscapes: an objective on a grid over one or two parameters."""

from __future__ import annotations

from flexor.study.landscape.evaluate import landscape, resume_landscape
from flexor.study.landscape.result import Landscape, SearchPath

__all__ = ["Landscape", "SearchPath", "landscape", "resume_landscape"]
