"""Mapping between designs and the unit box in which the methods work."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexor.optimizers.budgeted_evaluator import BudgetedEvaluator
from flexor.optimizers.interface import FloatArray
from flexor.optimizers.starts import starting_designs


class UnitBox:
    """Designs scaled to [0, 1]^k: 0 is the lower bound and 1 the upper bound.

    Parameters
    ----------
    function : BudgetedEvaluator
        Function to minimise, of designs in SI units.
    lower, upper : (k,) arrays
        Bounds.
    start : (k,) or (s, k) array or None
        Starting designs.
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
        self._start_designs: dict[bytes, FloatArray] = {}

    @property
    def size(self) -> int:
        """Number k of parameters."""
        return self.lower.size

    def starts(self, count: int, random: np.random.Generator) -> FloatArray:
        """Return the given starts, completed to ``count`` with a Latin hypercube, (s, k).

        Raises
        ------
        InputError
            If a given start is outside the bounds.
        """
        designs = starting_designs(self._start, count, self.lower, self.upper, random)
        points = self.points(designs)
        # Scaling there and back may change the last bit; starts are evaluated exactly as given.
        self._start_designs.update(
            (point.tobytes(), design) for point, design in zip(points, designs, strict=True)
        )
        return points

    def points(self, designs: FloatArray) -> FloatArray:
        """Scale designs (n, k) to points (n, k)."""
        return np.clip((designs - self.lower) / (self.upper - self.lower), 0.0, 1.0) + 0.0

    def designs(self, points: ArrayLike) -> FloatArray:
        """Scale points (n, k) to designs (n, k) within the bounds."""
        clipped = np.clip(np.asarray(points, dtype=np.float64), 0.0, 1.0) + 0.0
        designs = self.lower + clipped * (self.upper - self.lower)
        # At 1 rounding may miss the upper bound.
        designs = np.clip(np.where(clipped == 1.0, self.upper, designs), self.lower, self.upper)
        for row, point in enumerate(clipped):
            if (start := self._start_designs.get(point.tobytes())) is not None:
                designs[row] = start
        return designs

    def values(self, points: ArrayLike) -> FloatArray:
        """Return the values (n,) at points (n, k), as one batch; +inf for failures."""
        return self.function(self.designs(points))

    def residuals(self, points: ArrayLike) -> FloatArray:
        """Return the residual vectors (n, r) at points (n, k), as one batch; NaN for failures."""
        return self.function.residuals(self.designs(points))

    def jacobian(self, points: ArrayLike) -> FloatArray | None:
        """Return the exact Jacobians (n, r, k) at points (n, k), or None if not available."""
        result = self.function.jacobian(self.designs(points))
        return None if result is None else result * (self.upper - self.lower)

    def gradient(self, points: ArrayLike) -> FloatArray | None:
        """Return the exact gradients (n, k) at points (n, k), or None if not available."""
        result = self.function.gradient(self.designs(points))
        return None if result is None else result * (self.upper - self.lower)


def penalize_failures(values: FloatArray) -> NDArray[np.float64]:
    """Replace non-finite values by a large finite penalty, for methods that need finite values."""
    return np.where(np.isfinite(values), values, 1e30)
