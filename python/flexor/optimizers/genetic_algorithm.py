"""Genetic algorithm, from pymoo."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import at_least, option
from flexor.optimizers.pymoo_loop import generations


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

    name: ClassVar[str] = "genetic-algorithm"

    population: int = option(32, at_least(4))
    patience: int = option(50, at_least(1))

    def run(self, run: Run) -> str:
        """Evolve until no improvement is found."""
        from pymoo.algorithms.soo.nonconvex.ga import GA
        from pymoo.operators.crossover.sbx import SBX
        from pymoo.operators.mutation.pm import PM

        algorithm = GA(
            pop_size=self.population,
            sampling=run.starts(self.population),
            crossover=SBX(),
            mutation=PM(),
        )
        return generations(run, algorithm, self.patience)
