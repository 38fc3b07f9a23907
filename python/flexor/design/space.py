"""The exosuit that a parameter set modifies, and the bounds of its parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


class Space(Protocol):
    """Design space of a model, from the ``[design]`` table of its file; all values in m.

    The rod's own length and radii are the default start of a search, and are kept where a set
    does not change them.
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
        """Bounds of the length."""
        ...

    @property
    def radius_bounds(self) -> tuple[float, float]:
        """Bounds of the base and tip radius."""
        ...

    @property
    def minimum_radius(self) -> float:
        """Lower limit of the radius of general profiles."""
        ...


@dataclass(frozen=True)
class DesignSpace:
    """A `Space` with given values [m]; the defaults are the paper's.

    Length and radii are from Table I, the minimum radius of 0.5 cm from section II-B and the
    radius bounds from Fig. 4. The paper states no bounds of the length; 6-14 cm includes the
    default (10), all published optima (7.97-10.8) and the length of the finger (9.5).
    """

    length: float = 0.10
    radius_base: float = 0.0116
    radius_tip: float = 0.008
    length_bounds: tuple[float, float] = (0.06, 0.14)
    radius_bounds: tuple[float, float] = (0.004, 0.012)
    minimum_radius: float = 0.005


PAPER = DesignSpace()
