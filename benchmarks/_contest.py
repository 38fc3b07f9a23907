"""Definition of a comparison with another library."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Contest:
    """One task solved by another library and by Flexor.

    Attributes
    ----------
    peer : str
        Name of the library, with versions.
    work : str
        The task.
    unlike : str
        Differences between the two computations.
    theirs, ours : callable
        Solve the task for `units` problems.
    units : tuple of int
        Number of problems per call of theirs and ours.
    deviation : callable
        Returns the largest deviation of the results, relative to the scale of the quantity, and a
        remark or an empty string.
    expected : float
        Expected deviation from the peer's discretisation and tolerance.
    compared : str
        The compared quantity.
    """

    peer: str
    work: str
    unlike: str
    theirs: Callable[[], object]
    ours: Callable[[], object]
    units: tuple[int, int]
    deviation: Callable[[], tuple[float, str]]
    expected: float
    compared: str
