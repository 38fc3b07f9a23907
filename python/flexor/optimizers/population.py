"""Population methods, from pymoo."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import at_least, at_most, option


class PopulationMethod(Method):
    """A pymoo algorithm that runs until it no longer improves, each generation one batch."""

    packages = ("pymoo",)

    population: int
    patience: int

    @abstractmethod
    def algorithm(self, run: Run) -> Any:
        """Return the pymoo algorithm with its first generation."""

    def run(self, run: Run) -> str:
        """Iterate until no improvement is found."""
        from pymoo.core.evaluator import Evaluator
        from pymoo.core.problem import Problem
        from pymoo.core.termination import NoTermination
        from pymoo.problems.static import StaticProblem

        k = run.size
        problem = Problem(n_var=k, n_obj=1, xl=np.zeros(k), xu=np.ones(k))
        algorithm = self.algorithm(run)
        algorithm.setup(problem, termination=NoTermination(), seed=run.seed, verbose=False)
        best, stalled = np.inf, 0
        while stalled < self.patience:
            infills = algorithm.ask()
            if infills is None or len(infills) == 0:
                return "the population has lost its diversity"
            points = infills.get("X").astype(np.float64)
            evaluated = StaticProblem(problem, F=run.values(points)[:, None])
            Evaluator().eval(evaluated, infills)
            algorithm.tell(infills=infills)
            stalled = 0 if run.function.value < best else stalled + 1
            best = run.function.value
            spread = np.ptp(algorithm.pop.get("X").astype(np.float64), axis=0).max()
            run.step(f"spread {spread:.2g}")
        return f"no improvement in {self.patience} generations"


@dataclass(frozen=True)
class GeneticAlgorithm(PopulationMethod):
    """Real-coded genetic algorithm with tournament selection, SBX and polynomial mutation.

    Attributes
    ----------
    population : int
        Population size; the first generation includes the given starts.
    patience : int
        Stop after this many generations without improvement.
    """

    name = "genetic-algorithm"
    title = "genetic algorithm"
    aliases = ("ga",)
    description = "real-coded genetic algorithm"

    population: int = option(32, at_least(4))
    patience: int = option(50, at_least(1))

    def algorithm(self, run: Run) -> Any:
        """Return the pymoo algorithm with its first generation."""
        from pymoo.algorithms.soo.nonconvex.ga import GA
        from pymoo.operators.crossover.sbx import SBX
        from pymoo.operators.mutation.pm import PM

        starts = run.starts(self.population)
        return GA(pop_size=self.population, sampling=starts, crossover=SBX(), mutation=PM())


@dataclass(frozen=True)
class DifferentialEvolution(PopulationMethod):
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

    name = "differential-evolution"
    title = "differential evolution"
    aliases = ("de",)
    description = "differential evolution, DE/rand/1/bin"

    population: int = option(32, at_least(5))
    crossover: float = option(0.7, at_most(1))
    patience: int = option(50, at_least(1))

    def algorithm(self, run: Run) -> Any:
        """Return the pymoo algorithm with its first generation."""
        from pymoo.algorithms.soo.nonconvex.de import DE

        starts, variant = run.starts(self.population), "DE/rand/1/bin"
        return DE(pop_size=self.population, sampling=starts, variant=variant, CR=self.crossover)


@dataclass(frozen=True)
class ParticleSwarm(PopulationMethod):
    """Particle swarm with adaptive coefficients (Zhan et al. 2009).

    Attributes
    ----------
    population : int
        Number of particles, including the given starts.
    patience : int
        Stop after this many generations without improvement.
    """

    name = "particle-swarm"
    title = "particle swarm"
    aliases = ("pso",)
    description = "particle swarm with adaptive coefficients"

    population: int = option(32, at_least(2))
    patience: int = option(50, at_least(1))

    def algorithm(self, run: Run) -> Any:
        """Return the pymoo algorithm with its first generation."""
        from pymoo.algorithms.soo.nonconvex.pso import PSO

        return PSO(pop_size=self.population, sampling=run.starts(self.population))
