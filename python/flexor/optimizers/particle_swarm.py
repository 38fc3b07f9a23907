"""Particle swarm optimisation, from pymoo."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import at_least, option
from flexor.optimizers.pymoo_loop import generations


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

    name: ClassVar[str] = "particle-swarm"

    population: int = option(32, at_least(2))
    patience: int = option(50, at_least(1))

    def run(self, run: Run) -> str:
        """Iterate until no improvement is found."""
        from pymoo.algorithms.soo.nonconvex.pso import PSO

        algorithm = PSO(pop_size=self.population, sampling=run.starts(self.population))
        return generations(run, algorithm, self.patience)
