"""A quantity of every equilibrium of a path, by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from flexor.arrays import Array
from flexor.model.units import Dimension

if TYPE_CHECKING:
    from flexor.model.results import Paths, State

Worst = Literal["most", "least"]


@dataclass(frozen=True)
class Observable:
    """A quantity of every equilibrium of a path.

    Attributes
    ----------
    name : str
        Such as ``"bending"`` or ``"angle.ph_1"``.
    dimension : Dimension or None
        What it is measured in; None for plain numbers.
    unit : tuple of float and str
        The unit for display, in SI and by name.
    text : str
        What it is, in one line.
    values : callable
        From `flexor.model.Paths` of n designs to its values (n, s), SI; NaN where there is no
        equilibrium.
    joints : tuple of float or None
        Its derivative with respect to the joints' coordinates, for those that are a sum of these
        at the same load; the engine then gives its gradient.
    of_tip : bool
        Whether it is the tip force, whose gradient the engine gives.
    place : callable or None
        From a `flexor.model.State` to the place of an extreme, such as ``"exosuit, X = 0.5"``.
    """

    name: str
    dimension: Dimension | None
    unit: tuple[float, str]
    text: str
    values: Callable[[Paths], Array]
    joints: tuple[float, ...] | None = None
    of_tip: bool = False
    place: Callable[[State], str] | None = field(default=None, compare=False)

    @property
    def differentiable(self) -> bool:
        """Whether the engine gives its gradient, at the last load."""
        return self.of_tip or self.joints is not None

    def shown(self, value: float, digits: int = 4) -> str:
        """Return a value in its unit for display."""
        number = f"{value / self.unit[0]:.{digits}g}"
        return f"{'0' if number == '-0' else number} {self.unit[1]}".rstrip()

    def last(self, paths: Paths) -> Array:
        """Return the values at the last load, (n,)."""
        return np.asarray(self.values(paths)[:, -1])
