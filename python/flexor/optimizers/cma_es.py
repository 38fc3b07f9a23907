"""CMA-ES, from the package cma."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run, penalize_failures
from flexor.optimizers.options import FRACTION, Range, at_least, at_most, option


@dataclass(frozen=True)
class CmaEs(Method):
    """Covariance matrix adaptation evolution strategy (Hansen) with IPOP restarts.

    The first run begins at the start with a large step size; each restart begins at a random
    design with twice the population. The package needs at least two dimensions, so problems of
    one parameter get a second one without effect.

    Attributes
    ----------
    population : int
        Population size; 0 selects the default 4 + 3 ln k, but at least 8.
    step : float
        Initial standard deviation as a fraction of each parameter's range.
    restarts : int
        Number of restarts.
    tolerance : float
        A run stops when its step sizes, as fractions of the ranges, fall below this.
    """

    name = "cma-es"
    title = "CMA-ES"
    aliases = ("cma", "cmaes")
    description = "covariance matrix adaptation evolution strategy with restarts"
    packages = ("cma",)

    population: int = option(
        0, Range(lambda value: value == 0 or value >= 4, "at least 4, or 0 for the default")
    )
    step: float = option(0.3, at_most(1))
    restarts: int = option(3, at_least(0))
    tolerance: float = option(1e-6, FRACTION)

    def run(self, run: Run) -> str:
        """Run CMA-ES with its restarts."""
        starts = run.starts(1)
        values = run.values(starts)
        mean = starts[int(np.argmin(values))]
        population = self.population or max(8, 4 + int(3.0 * math.log(run.size)))
        reason = ""
        for restart in range(self.restarts + 1):
            reason = self._single_run(run, mean, population, restart)
            mean, population = run.random.uniform(size=run.size), 2 * population
        return f"{reason}, after {self.restarts} restarts" if self.restarts else reason

    def _single_run(self, run: Run, mean: FloatArray, population: int, restart: int) -> str:
        from cma import CMAEvolutionStrategy

        k = run.size
        strategy = CMAEvolutionStrategy(
            mean if k > 1 else np.append(mean, 0.5),
            self.step,
            {
                "bounds": [0.0, 1.0],
                "popsize": population,
                "randn": lambda *shape: run.random.standard_normal(shape),
                "seed": math.nan,  # do not seed numpy's global generator
                "tolx": self.tolerance,
                "tolfun": 1e-11,
                "verbose": -9,
            },
        )
        while not (stop := strategy.stop()):
            candidates = strategy.ask()
            points = np.array(candidates)[:, :k]
            strategy.tell(candidates, penalize_failures(run.values(points)).tolist())
            run.step(f"run {restart + 1} of {self.restarts + 1}, step {strategy.sigma:.2g}")
        return f"CMA-ES stopped by {', '.join(stop)}"
