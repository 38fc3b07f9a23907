"""The studio: a model in a browser that solves again while its dimensions and loads move.

Every request says which design it is about, so that tabs share nothing. `Workbench` answers
requests, `serve` lets a browser ask them.
"""

from __future__ import annotations

from flexor.studio.server import Studio, serve
from flexor.studio.workbench import Workbench, workbench

__all__ = ["Studio", "Workbench", "serve", "workbench"]
