"""Coarse pattern search followed by local quasi-Newton searches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from flexor.optimizers.method import Method, Run
from flexor.optimizers.multistart_bfgs import minimize_lbfgsb
from flexor.optimizers.options import FRACTION, at_least, at_most, option
from flexor.optimizers.pattern import PatternSearch


@dataclass(frozen=True)
class PolishedPattern(Method):
    """Generalised pattern search to a coarse mesh, then L-BFGS-B from the result of each start.

    The pattern search steps over shallow local minima; the quasi-Newton search refines its result.

    Attributes
    ----------
    starts : int
        Number of starts, including the given ones.
    initial_mesh, mesh : float
        Initial and final mesh size of the pattern search, as fractions of the ranges.
    tolerance : float
        Tolerance of the projected gradient in the unit box; its square is the tolerance of the
        relative decrease in one step.
    iterations : int
        Maximum number of iterations of each local search.
    difference : float
        Finite-difference step where there is no exact gradient, as a fraction of the ranges.
    """

    name = "pattern-search+polish"
    title = "polished pattern search"
    aliases = ("ps+polish", "polish")
    description = (
        "coarse pattern search followed by local quasi-Newton searches with exact gradients"
    )
    packages = ("scipy",)
    gradients: ClassVar[bool] = True

    starts: int = option(1, at_least(1))
    initial_mesh: float = option(0.25, at_most(1))
    mesh: float = option(0.05, FRACTION)
    tolerance: float = option(1e-6, FRACTION)
    iterations: int = option(100, at_least(1))
    difference: float = option(1e-6, at_most(0.1))

    def run(self, run: Run) -> str:
        """Run the pattern search, then a local search from each of its results, best first."""
        starts = run.starts(self.starts)
        coarse = PatternSearch(initial_mesh=self.initial_mesh, tolerance=self.mesh)
        polls = []
        box = np.zeros(run.size), np.ones(run.size)
        for polls in coarse.iterate(run.values, *box, start=starts, seed=run.seed):
            run.step(f"mesh {max(poll.mesh for poll in polls):.3g}")
        found = sorted((p for p in polls if np.isfinite(p.value)), key=lambda poll: poll.value)
        for poll in found:
            minimize_lbfgsb(run, poll.design, self.difference, self.tolerance, self.iterations)
        if not found:
            return "no start succeeded" if self.starts > 1 else "the start failed"
        return f"polished at a mesh of {self.mesh:g}"
