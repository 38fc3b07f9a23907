"""Dual annealing, from SciPy."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run, penalize_failures
from flexor.optimizers.multistart_bfgs import difference_gradient
from flexor.optimizers.options import at_least, option

# Finite-difference step of the local searches, as a fraction of the ranges.
DIFFERENCE = 1e-6
# Number of requested designs between progress reports.
REPORT_INTERVAL = 50


@dataclass(frozen=True)
class DualAnnealing(Method):
    """Generalised simulated annealing (Xiang 1997) with local searches.

    The annealing evaluates designs one at a time; each finite-difference gradient of the local
    search (L-BFGS-B) is one batch.

    Attributes
    ----------
    iterations : int
        Annealing iterations; each takes two designs per parameter and possibly a local search.
    local : bool
        Whether to run local searches.
    """

    name = "dual-annealing"
    title = "dual annealing"
    aliases = ("annealing", "da")
    description = "generalised simulated annealing with local searches"
    packages = ("scipy",)

    iterations: int = option(1000, at_least(1))
    local: bool = True

    def run(self, run: Run) -> str:
        """Run all annealing iterations."""
        from scipy.optimize import dual_annealing

        starts = run.starts(1)
        start = starts[int(np.argmin(run.values(starts)))]

        requests = itertools.count(1)

        def value(point: FloatArray) -> float:
            if next(requests) % REPORT_INTERVAL == 0:
                run.step("annealing")
            return float(penalize_failures(run.values(point[None, :]))[0])

        def gradient(point: FloatArray) -> FloatArray:
            return difference_gradient(run, point, DIFFERENCE)

        box = [(0.0, 1.0)] * run.size
        dual_annealing(
            value,
            box,
            maxiter=self.iterations,
            maxfun=10**9,
            x0=start,
            rng=run.random,
            no_local_search=not self.local,
            minimizer_kwargs={"method": "L-BFGS-B", "jac": gradient, "bounds": box},
        )
        return f"{self.iterations} iterations"
