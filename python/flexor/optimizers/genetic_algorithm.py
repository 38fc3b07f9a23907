"""Genetic algorithm, from pymoo."""

from __future__ import annotations

from dataclasses import dataclass

from flexor.optimizers.method import Method, Run
from flexor.optimizers.pymoo_loop import check_population, first_population, generations


@dataclass(frozen=True)
class GeneticAlgorithm(Method):
    """Real-coded genetic algorithm with tournament selection, SBX and polynomial mutation.

    Attributes
    ----------
    population : int
        Population size; the first generation includes the given starts.
    patience : int
        Stop after this many generations without improvement.
    """

    population: int = 32
    patience: int = 50

    def __post_init__(self) -> None:
        """Check the options.

        Raises
        ------
        InputError
            If one is out of its range.
        """
        check_population(self.name, self.population, self.patience, least=4)

    @property
    def name(self) -> str:
        """``"genetic-algorithm"``."""
        return "genetic-algorithm"

    def run(self, run: Run) -> str:
        """Evolve until no improvement is found."""
        from pymoo.algorithms.soo.nonconvex.ga import GA
        from pymoo.operators.crossover.sbx import SBX
        from pymoo.operators.mutation.pm import PM

        algorithm = GA(
            pop_size=self.population,
            sampling=first_population(run, self.population),
            crossover=SBX(),
            mutation=PM(),
        )
        return generations(run, algorithm, self.patience)
