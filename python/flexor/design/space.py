"""The rod that a parameter set changes, and the bounds within which it may."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


class Space(Protocol):
    """What a parameter set needs to know of a model; a model file's ``[design]`` gives it.

    All in m. The rod's own length and radii are the start of every search and stay as they are
    where a set does not change them.
    """

    @property
    def length(self) -> float:
        """Length of the model's own exosuit."""
        ...

    @property
    def radius_base(self) -> float:
        """Its radius at the base, R_0."""
        ...

    @property
    def radius_tip(self) -> float:
        """Its radius at the tip, R_1."""
        ...

    @property
    def length_bounds(self) -> tuple[float, float]:
        """Lowest and highest length of the search."""
        ...

    @property
    def radius_bounds(self) -> tuple[float, float]:
        """Lowest and highest base and tip radius of the search."""
        ...

    @property
    def minimum_radius(self) -> float:
        """Thinnest surface that a general profile may have."""
        ...


@dataclass(frozen=True)
class DesignSpace:
    """A `Space` by numbers [m]; the defaults are the paper's.

    Length and radii are those of Table I, 0.5 cm the minimum radius of its section II-B and
    0.4-1.2 cm the range of its Fig. 4. It states no range of lengths: 6-14 cm holds the default
    (10), every published optimum (7.97-10.8), and half to more than the whole of the finger (9.5).
    """

    length: float = 0.10
    radius_base: float = 0.0116
    radius_tip: float = 0.008
    length_bounds: tuple[float, float] = (0.06, 0.14)
    radius_bounds: tuple[float, float] = (0.004, 0.012)
    minimum_radius: float = 0.005


PAPER = DesignSpace()
