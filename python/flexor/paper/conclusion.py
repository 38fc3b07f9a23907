"""A conclusion of the paper and what became of it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Conclusion:
    """A conclusion of the paper and what became of it.

    Attributes
    ----------
    claim : str
        What the paper says.
    place : str
        Where.
    holds : bool
        Whether it holds in our model.
    evidence : str
        The numbers.
    """

    claim: str
    place: str
    holds: bool
    evidence: str
