"""Differential evolution, from pymoo."""

from __future__ import annotations

from dataclasses import dataclass

from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import require
from flexor.optimizers.pymoo_loop import check_population, first_population, generations


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

    population: int = 32
    crossover: float = 0.7
    patience: int = 50

    def __post_init__(self) -> None:
        """Check the options.

        Raises
        ------
        InputError
            If one is out of its range.
        """
        check_population(self.name, self.population, self.patience, least=5)
        valid = 0.0 < self.crossover <= 1.0
        require(self.name, "crossover", self.crossover, valid, "above 0 and at most 1")

    @property
    def name(self) -> str:
        """``"differential-evolution"``."""
        return "differential-evolution"

    def run(self, run: Run) -> str:
        """Evolve until no improvement is found."""
        from pymoo.algorithms.soo.nonconvex.de import DE

        algorithm = DE(
            pop_size=self.population,
            sampling=first_population(run, self.population),
            variant="DE/rand/1/bin",
            CR=self.crossover,
        )
        return generations(run, algorithm, self.patience)
