"""CMA-ES, from the package cma."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import require
from flexor.optimizers.unit_box import penalize_failures


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

    population: int = 0
    step: float = 0.3
    restarts: int = 3
    tolerance: float = 1e-6

    def __post_init__(self) -> None:
        """Check the options.

        Raises
        ------
        InputError
            If one is out of its range.
        """
        population_valid = self.population == 0 or self.population >= 4
        for option, valid, allowed in (
            ("population", population_valid, "at least 4, or 0 for the default"),
            ("step", 0.0 < self.step <= 1.0, "above 0 and at most 1"),
            ("restarts", self.restarts >= 0, "at least 0"),
            ("tolerance", 0.0 < self.tolerance < 1.0, "between 0 and 1"),
        ):
            require(self.name, option, getattr(self, option), valid, allowed)

    @property
    def name(self) -> str:
        """``"cma-es"``."""
        return "cma-es"

    def run(self, run: Run) -> str:
        """Run CMA-ES with its restarts."""
        random = np.random.default_rng(run.seed)
        starts = run.starts(1, random)
        values = run.values(starts)
        mean = starts[int(np.argmin(values))]
        population = self.population or max(8, 4 + int(3.0 * math.log(run.size)))
        reason = ""
        for restart in range(self.restarts + 1):
            reason = self._single_run(run, mean, population, random, restart)
            mean, population = random.uniform(size=run.size), 2 * population
        return f"{reason}, after {self.restarts} restarts" if self.restarts else reason

    def _single_run(
        self, run: Run, mean: FloatArray, population: int, random: np.random.Generator, restart: int
    ) -> str:
        from cma import CMAEvolutionStrategy

        k = run.size
        strategy = CMAEvolutionStrategy(
            mean if k > 1 else np.append(mean, 0.5),
            self.step,
            {
                "bounds": [0.0, 1.0],
                "popsize": population,
                "randn": _normal_sampler(random),
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


def _normal_sampler(random: np.random.Generator) -> Callable[..., Any]:
    def normal(*shape: int) -> Any:
        return random.standard_normal(shape)

    return normal
