"""The unit box in which the methods work, whatever the units of the parameters are."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexor.optimizers.budgeted_evaluator import BudgetedEvaluator
from flexor.optimizers.interface import FloatArray
from flexor.optimizers.starts import starting_designs


class UnitBox:
    """Designs as points of [0, 1]^k: 0 is the lower bound and 1 the upper.

    Parameters
    ----------
    function : BudgetedEvaluator
        What is minimised, of designs in their own units.
    lower, upper : (k,) arrays
        Bounds.
    start : (k,) or (s, k) array or None
        Where the search is to begin.
    """

    def __init__(
        self,
        function: BudgetedEvaluator,
        lower: FloatArray,
        upper: FloatArray,
        start: ArrayLike | None,
    ) -> None:
        self.function = function
        self.lower = np.asarray(lower, dtype=np.float64)
        self.upper = np.asarray(upper, dtype=np.float64)
        self._start = start
        self._exact: dict[bytes, FloatArray] = {}

    @property
    def size(self) -> int:
        """Number k of parameters."""
        return self.lower.size

    def starts(self, count: int, random: np.random.Generator) -> FloatArray:
        """Return the given starts, completed to ``count`` by a Latin hypercube, (s, k) in the box.

        Raises
        ------
        InputError
            If a given start is outside the bounds.
        """
        designs = starting_designs(self._start, count, self.lower, self.upper, random)
        points = self.points(designs)
        # There and back again costs a last digit, but a start is evaluated as it was given.
        self._exact.update(
            (point.tobytes(), design) for point, design in zip(points, designs, strict=True)
        )
        return points

    def points(self, designs: FloatArray) -> FloatArray:
        """Points (n, k) of designs (n, k)."""
        return np.clip((designs - self.lower) / (self.upper - self.lower), 0.0, 1.0) + 0.0

    def designs(self, points: ArrayLike) -> FloatArray:
        """Designs (n, k) of points (n, k), never outside the bounds."""
        inside = np.clip(np.asarray(points, dtype=np.float64), 0.0, 1.0) + 0.0
        designs = self.lower + inside * (self.upper - self.lower)
        # At 1 the sum may miss the upper bound by a rounding.
        designs = np.clip(np.where(inside == 1.0, self.upper, designs), self.lower, self.upper)
        for row, point in enumerate(inside):
            if (exact := self._exact.get(point.tobytes())) is not None:
                designs[row] = exact
        return designs

    def values(self, points: ArrayLike) -> FloatArray:
        """Values (n,) at points (n, k), as one batch; +inf where a design failed."""
        return self.function(self.designs(points))

    def residuals(self, points: ArrayLike) -> FloatArray:
        """Vectors (n, r) at points (n, k), as one batch; NaN where a design failed."""
        return self.function.residuals(self.designs(points))

    def jacobian(self, points: ArrayLike) -> FloatArray | None:
        """Exact Jacobians (n, r, k) at points (n, k), or None if the function has none."""
        found = self.function.jacobian(self.designs(points))
        return None if found is None else found * (self.upper - self.lower)

    def gradient(self, points: ArrayLike) -> FloatArray | None:
        """Exact gradients (n, k) at points (n, k), or None if the function has none."""
        found = self.function.gradient(self.designs(points))
        return None if found is None else found * (self.upper - self.lower)


def finite(values: FloatArray) -> NDArray[np.float64]:
    """Return values with failures as a large finite number, for methods that compute with them."""
    return np.where(np.isfinite(values), values, 1e30)
