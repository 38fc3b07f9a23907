"""What decides the numbers of a reproduction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from flexor.errors import InputError

# In the order of Table III.
SETS = ("L", "R01", "L+R01", "Rsc", "L+Rsc", "RLP", "L+RLP")
# In the order of Table IV; the last is f_bc as printed, which the paper's words contradict.
OBJECTIVES = ("bending", "tip-force", "bending-contact", "bending-contact-printed")
# Constants of the shipped models: as printed, and fitted to the printed angles in two readings.
PRINTED = "printed"
CALIBRATED = ("calibrated", "calibrated-optimum")
# Bayesian search is left out: its own work for a design takes longer than a hundred designs here.
COMPARED_METHODS = (
    "levenberg-marquardt",
    "pattern-search",
    "genetic-algorithm",
    "differential-evolution",
    "particle-swarm",
    "cma-es",
    "direct",
    "mads",
)


@dataclass(frozen=True)
class Settings:
    """Settings of a reproduction.

    Attributes
    ----------
    constants : str
        Set of constants of the shipped models.
    seed : int
        Of everything drawn at random.
    grid : int
        Points along each axis of the landscape.
    search : int
        Designs that each search done as in the paper may evaluate.
    thorough : int
        Designs that the search for a true optimum evaluates for each parameter of the set.
    compared_seeds : int
        Searches of each method on each set.
    compared_budget : int
        Evaluations of each of them.
    """

    constants: str = "calibrated"
    seed: int = 0
    grid: int = 81
    search: int = 10_000
    thorough: int = 1500
    compared_seeds: int = 10
    compared_budget: int = 300

    def __post_init__(self) -> None:
        """Check the numbers.

        Raises
        ------
        InputError
            If one is out of its range.
        """
        for name, least in (
            ("seed", 0),
            ("grid", 3),
            ("search", 10),
            ("thorough", 50),
            ("compared_seeds", 1),
            ("compared_budget", 10),
        ):
            if getattr(self, name) < least:
                raise InputError(f"{name} must be at least {least}, got {getattr(self, name)}.")

    def to_dict(self) -> dict[str, Any]:
        """Return the settings as plain values."""
        return asdict(self)

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Settings:
        """Make settings of plain values."""
        return cls(**values)


def other_reading(constants: str) -> str:
    """Return the calibrated set of constants that stands beside another set."""
    return next(name for name in CALIBRATED if name != constants)
