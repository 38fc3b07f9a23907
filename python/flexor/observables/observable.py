"""A quantity of every equilibrium of a path, by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.units import Dimension

if TYPE_CHECKING:
    from flexor.model.derivatives import Differential
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
    slope : callable or None
        From paths and a step of each, (n,), to the first-order change of its values there, a
        `flexor.model.derivatives.Differential`; None where it has no derivative.
    lowest : float or None
        The value that it is never below, SI.
    place : callable or None
        From a `flexor.model.State` to the place of an extreme, such as ``"exosuit, X = 0.5"``.
    costly : bool
        Whether pages leave it out that do not ask for it, as it takes longer than the others.
    """

    name: str
    dimension: Dimension | None
    unit: tuple[float, str]
    text: str
    values: Callable[[Paths], Array]
    slope: Callable[[Paths, NDArray[np.intp]], Differential] | None = None
    lowest: float | None = None
    place: Callable[[State], str] | None = field(default=None, compare=False)
    costly: bool = False

    @property
    def differentiable(self) -> bool:
        """Whether it has exact derivatives."""
        return self.slope is not None

    def shown(self, value: float, digits: int = 4) -> str:
        """Return a value in its unit for display."""
        number = f"{value / self.unit[0]:.{digits}g}"
        return f"{'0' if number == '-0' else number} {self.unit[1]}".rstrip()

    def last(self, paths: Paths) -> Array:
        """Return the values at the last load, (n,)."""
        return np.asarray(self.values(paths)[:, -1])

    def differential(self, paths: Paths, steps: NDArray[np.intp]) -> Differential:
        """Return the first-order change of the values at one step of each path, (n,).

        InputError if it has no derivative.
        """
        if self.slope is None:
            raise InputError(f'"{self.name}" has no exact derivative.')
        return self.slope(paths, steps)
