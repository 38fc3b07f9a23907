"""CMA-ES, of cma."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import require
from flexor.optimizers.unit_box import finite


@dataclass(frozen=True)
class CmaEs(Method):
    """Covariance matrix adaptation (Hansen), restarted with ever larger populations (IPOP).

    The first run begins at the start with a wide step; each restart anywhere, with twice the
    population. In one dimension, which the method does not know, a second one without effect is
    added.

    Attributes
    ----------
    population : int
        Designs of each generation; 0 for the method's own 4 + 3 ln k, but at least 8.
    step : float
        First standard deviation as a fraction of the range of each parameter.
    restarts : int
        So many runs after the first.
    tolerance : float
        A run ends when its steps, as fractions of the ranges, fall below this.
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
        good = self.population == 0 or self.population >= 4
        for option, inside, allowed in (
            ("population", good, "at least 4, or 0 for the method's own"),
            ("step", 0.0 < self.step <= 1.0, "above 0 and at most 1"),
            ("restarts", self.restarts >= 0, "at least 0"),
            ("tolerance", 0.0 < self.tolerance < 1.0, "between 0 and 1"),
        ):
            require(self.name, option, getattr(self, option), inside, allowed)

    @property
    def name(self) -> str:
        """``"cma-es"``."""
        return "cma-es"

    def run(self, run: Run) -> str:
        """Adapt, and restart, until the last run ends."""
        random = np.random.default_rng(run.seed)
        starts = run.starts(1, random)
        values = run.values(starts)
        mean = starts[int(np.argmin(values))]
        population = self.population or max(8, 4 + int(3.0 * math.log(run.size)))
        reason = ""
        for restart in range(self.restarts + 1):
            reason = self._adapt(run, mean, population, random, restart)
            mean, population = random.uniform(size=run.size), 2 * population
        return f"{reason}, after {self.restarts} restarts" if self.restarts else reason

    def _adapt(
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
                "randn": _normal(random),
                "seed": math.nan,  # leaves numpy's global state alone
                "tolx": self.tolerance,
                "tolfun": 1e-11,
                "verbose": -9,
            },
        )
        while not (stop := strategy.stop()):
            asked = strategy.ask()
            points = np.array(asked)[:, :k]
            strategy.tell(asked, finite(run.values(points)).tolist())
            run.step(f"run {restart + 1} of {self.restarts + 1}, step {strategy.sigma:.2g}")
        return f"CMA-ES stopped by {', '.join(stop)}"


def _normal(random: np.random.Generator) -> Callable[..., Any]:
    def normal(*shape: int) -> Any:
        return random.standard_normal(shape)

    return normal
