"""A genetic algorithm, of pymoo."""

from __future__ import annotations

from dataclasses import dataclass

from flexor.optimizers.method import Method, Run
from flexor.optimizers.pymoo_loop import check_population, first_population, generations


@dataclass(frozen=True)
class GeneticAlgorithm(Method):
    """Real-coded genetic algorithm: tournaments, simulated binary crossover, polynomial mutation.

    Attributes
    ----------
    population : int
        Designs of each generation, the given starts among the first.
    patience : int
        It ends after so many generations without a better design.
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
        """Evolve until nothing better comes."""
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
