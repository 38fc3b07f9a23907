"""Base class of the methods, and one run of a method in the unit box."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike

from flexor.optimizers.budgeted_evaluator import BudgetedEvaluator, BudgetExhausted
from flexor.optimizers.interface import (
    BatchFunction,
    Budget,
    FloatArray,
    Linearized,
    ProgressCallback,
    SearchResult,
)
from flexor.optimizers.options import Options
from flexor.optimizers.starts import starting_designs

# A converged method may request cached designs indefinitely; stop it after this many iterations
# without a new one.
STAGNATION_LIMIT = 100


class Stagnated(Exception):
    """Raised when a method has stopped requesting new designs."""


class Run:
    """One run of a method: designs scaled to the unit box, their evaluation, progress reports.

    In the unit box [0, 1]^k, 0 is the lower bound and 1 the upper bound.
    """

    def __init__(
        self,
        function: BudgetedEvaluator,
        lower: FloatArray,
        upper: FloatArray,
        start: ArrayLike | None,
        seed: int,
        progress: ProgressCallback | None,
    ) -> None:
        self.function = function  # of designs in SI units
        self.lower = np.asarray(lower, dtype=np.float64)
        self.upper = np.asarray(upper, dtype=np.float64)
        self.seed = seed
        self.random = np.random.default_rng(seed)  # of further starts, and of the method
        self.iteration = 0  # how many are completed
        self._start = start
        self._start_designs: dict[bytes, FloatArray] = {}
        self._progress = progress
        self._last_new_design = (0, 0)

    @property
    def size(self) -> int:
        """Number k of parameters."""
        return self.lower.size

    def starts(self, count: int) -> FloatArray:
        """Return the given starts, completed to ``count`` with a Latin hypercube, (s, k).

        InputError if a given start is outside the bounds.
        """
        designs = starting_designs(self._start, count, self.lower, self.upper, self.random)
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

    def constrained(self, points: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return objective values (n,) and excesses (n, c) at points (n, k), as one batch."""
        return self.function.constrained(self.designs(points))

    def linearized(self, points: ArrayLike) -> Linearized | None:
        """Return `constrained` with the gradients of both by the unit box, (n, k) and (n, c, k).

        None if they are not available.
        """
        found = self.function.linearized(self.designs(points))
        if found is None:
            return None
        values, excesses, slopes, rises = found
        span = self.upper - self.lower
        return values, excesses, slopes * span, rises * span

    def objectives(self, points: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return values of several objectives (n, m) and excesses (n, c) at points (n, k)."""
        return self.function.objectives(self.designs(points))

    def step(self, detail: str, remaining: int | None = None) -> None:
        """Complete an iteration and report progress.

        ``detail`` is the state of the method, ``remaining`` how many evaluations follow if nothing
        improves. Stagnated if no new design was requested in `STAGNATION_LIMIT` iterations.
        """
        self.report(detail, remaining)
        self.iteration += 1
        if self.function.evaluations > self._last_new_design[1]:
            self._last_new_design = (self.iteration, self.function.evaluations)
        elif self.iteration - self._last_new_design[0] >= STAGNATION_LIMIT:
            raise Stagnated(f"no new design in {STAGNATION_LIMIT} iterations")

    def report(self, detail: str, remaining: int | None = None) -> None:
        """Report progress within an iteration."""
        if self._progress is not None and self.function.evaluations:
            self._progress(self.function.progress(self.iteration, detail, remaining))


class Method(Options, ABC):
    """Base class of searches implemented as one procedure on a `Run`.

    See `flexor.optimizers.Search`.
    """

    @abstractmethod
    def run(self, run: Run) -> str:
        """Run the search and return the reason for stopping."""

    def minimize(
        self,
        function: BatchFunction,
        lower: FloatArray,
        upper: FloatArray,
        start: ArrayLike | None = None,
        seed: int = 0,
        budget: Budget | None = None,
        progress: ProgressCallback | None = None,
    ) -> SearchResult:
        """Minimise; see `flexor.optimizers.Search`."""
        evaluator = BudgetedEvaluator(function, budget)
        run = Run(evaluator, lower, upper, start, seed, progress)
        try:
            reason = self.run(run)
        except (BudgetExhausted, Stagnated) as stop:
            reason = str(stop)
        run.report(reason, 0)
        return evaluator.result(run.iteration, reason)


def penalize_failures(values: FloatArray) -> FloatArray:
    """Replace non-finite values by a large finite penalty, for methods that need finite values."""
    return np.where(np.isfinite(values), values, 1e30)
