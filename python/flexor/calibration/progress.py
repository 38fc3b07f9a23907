"""Progress of a running calibration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """Where a calibration stands.

    Attributes
    ----------
    stage : str
        What it is doing.
    done, total : int
        How much of that.
    misfit : float
        The lowest so far.
    evaluated, replayed : int
        Paths and optima evaluated now, and known from an earlier run.
    """

    stage: str
    done: int
    total: int
    misfit: float
    evaluated: int
    replayed: int


ProgressCallback = Callable[[Progress], None]
