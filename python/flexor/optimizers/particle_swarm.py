"""Particle swarm optimisation, from pymoo."""

from __future__ import annotations

from dataclasses import dataclass

from flexor.optimizers.method import Method, Run
from flexor.optimizers.pymoo_loop import check_population, first_population, generations


@dataclass(frozen=True)
class ParticleSwarm(Method):
    """Particle swarm with adaptive coefficients (Zhan et al. 2009).

    Attributes
    ----------
    population : int
        Number of particles, including the given starts.
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
        check_population(self.name, self.population, self.patience, least=2)

    @property
    def name(self) -> str:
        """``"particle-swarm"``."""
        return "particle-swarm"

    def run(self, run: Run) -> str:
        """Iterate until no improvement is found."""
        from pymoo.algorithms.soo.nonconvex.pso import PSO

        algorithm = PSO(pop_size=self.population, sampling=first_population(run, self.population))
        return generations(run, algorithm, self.patience)
