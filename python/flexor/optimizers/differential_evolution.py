"""Differential evolution, from pymoo."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import at_least, at_most, option
from flexor.optimizers.pymoo_loop import generations


@dataclass(frozen=True)
class DifferentialEvolution(Method):
    """Differential evolution (Storn and Price 1997), variant DE/rand/1/bin.

    Attributes
    ----------
    population : int
        Population size; the first generation includes the given starts.
    crossover : float
        Crossover probability.
    patience : int
        Stop after this many generations without improvement.
    """

    name: ClassVar[str] = "differential-evolution"

    population: int = option(32, at_least(5))
    crossover: float = option(0.7, at_most(1))
    patience: int = option(50, at_least(1))

    def run(self, run: Run) -> str:
        """Evolve until no improvement is found."""
        from pymoo.algorithms.soo.nonconvex.de import DE

        algorithm = DE(
            pop_size=self.population,
            sampling=run.starts(self.population),
            variant="DE/rand/1/bin",
            CR=self.crossover,
        )
        return generations(run, algorithm, self.patience)
