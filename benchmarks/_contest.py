"""What a peer and Flexor are asked to do, each in its own way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Contest:
    """One work, done twice.

    Attributes
    ----------
    peer : str
        Who, with versions.
    work : str
        What both do.
    unlike : str
        What is not the same work.
    theirs, ours : callable
        Do it, for as many problems as `units` says.
    units : tuple of int
        How many problems theirs and ours solve in one call.
    deviation : callable
        The largest deviation of the answers, relative to the scale of the quantity, and what else
        is to be said of them, or nothing.
    expected : float
        What the peer's discretisation and tolerance let one expect of it.
    compared : str
        What is compared.
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
