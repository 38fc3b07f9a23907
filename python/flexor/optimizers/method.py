"""What the methods share: one way to run, to count, to report and to stop."""

from __future__ import annotations

from abc import ABC, abstractmethod

from numpy.typing import ArrayLike

from flexor.optimizers.budgeted_evaluator import BudgetedEvaluator, BudgetSpent
from flexor.optimizers.interface import (
    BatchFunction,
    Budget,
    FloatArray,
    ProgressCallback,
    SearchResult,
)
from flexor.optimizers.unit_box import UnitBox

# A method that has converged may go on asking for designs it has had already, for ever.
IDLE = 100


class Idle(Exception):
    """Raised to a method that no longer asks for anything new."""


class Run(UnitBox):
    """One run of a method: evaluation in the unit box, and reporting.

    Attributes
    ----------
    seed : int
        Random seed.
    iteration : int
        Iterations done.
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
        self._idle_since = (0, 0)

    def step(self, detail: str, remaining: int | None = None) -> None:
        """End an iteration and report the progress of the search.

        Parameters
        ----------
        detail : str
            In the method's own words.
        remaining : int, optional
            Evaluations still to come if nothing better is found any more.

        Raises
        ------
        Idle
            If nothing new was asked for in the last ``IDLE`` iterations.
        """
        self.report(detail, remaining)
        self.iteration += 1
        if self.function.evaluations > self._idle_since[1]:
            self._idle_since = (self.iteration, self.function.evaluations)
        elif self.iteration - self._idle_since[0] >= IDLE:
            raise Idle(f"nothing new to try in {IDLE} iterations")

    def report(self, detail: str, remaining: int | None = None) -> None:
        """Report the progress of the search, within an iteration."""
        if self._progress is not None and self.function.evaluations:
            self._progress(self.function.progress(self.iteration, detail, remaining))


class Method(ABC):
    """A search that is written as one procedure on a `Run`; see `flexor.optimizers.Search`.

    A method is a frozen dataclass whose fields are its options, all with defaults.
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """As written on the command line."""

    @abstractmethod
    def run(self, run: Run) -> str:
        """Search until done and say why it ended."""

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
        except (BudgetSpent, Idle) as spent:
            reason = str(spent)
        run.report(reason, 0)
        return evaluator.result(run.iteration, reason)
