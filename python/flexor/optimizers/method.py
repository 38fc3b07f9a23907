"""Base class of the methods: running, progress reports and stopping."""

from __future__ import annotations

from abc import ABC, abstractmethod

from numpy.typing import ArrayLike

from flexor.optimizers.budgeted_evaluator import BudgetedEvaluator, BudgetExhausted
from flexor.optimizers.interface import (
    BatchFunction,
    Budget,
    FloatArray,
    ProgressCallback,
    SearchResult,
)
from flexor.optimizers.unit_box import UnitBox

# A converged method may request cached designs indefinitely; stop it after this many iterations
# without a new one.
STAGNATION_LIMIT = 100


class Stagnated(Exception):
    """Raised when a method has stopped requesting new designs."""


class Run(UnitBox):
    """One run of a method: evaluation in the unit box and progress reports.

    Attributes
    ----------
    seed : int
        Random seed.
    iteration : int
        Iterations completed.
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
        super().__init__(function, lower, upper, start)
        self.seed = seed
        self.iteration = 0
        self._progress = progress
        self._last_new_design = (0, 0)

    def step(self, detail: str, remaining: int | None = None) -> None:
        """Complete an iteration and report progress.

        Parameters
        ----------
        detail : str
            Method-specific state.
        remaining : int, optional
            Remaining evaluations if no further improvement is found.

        Raises
        ------
        Stagnated
            If no new design was requested in the last ``STAGNATION_LIMIT`` iterations.
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


class Method(ABC):
    """Base class of searches implemented as one procedure on a `Run`.

    Subclasses are frozen dataclasses whose fields are the options, all with defaults. See
    `flexor.optimizers.Search`.
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """Name on the command line."""

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
