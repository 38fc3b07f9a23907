"""Coarse pattern search followed by local quasi-Newton searches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import require
from flexor.optimizers.pattern import PatternSearch
from flexor.optimizers.quasi_newton import minimize_lbfgsb


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

    gradients: ClassVar[bool] = True

    starts: int = 1
    initial_mesh: float = 0.25
    mesh: float = 0.05
    tolerance: float = 1e-6
    iterations: int = 100
    difference: float = 1e-6

    def __post_init__(self) -> None:
        """Check the options.

        Raises
        ------
        InputError
            If one is out of its range.
        """
        for option, valid, allowed in (
            ("starts", self.starts >= 1, "at least 1"),
            ("initial_mesh", 0.0 < self.initial_mesh <= 1.0, "above 0 and at most 1"),
            ("mesh", 0.0 < self.mesh < 1.0, "between 0 and 1"),
            ("tolerance", 0.0 < self.tolerance < 1.0, "between 0 and 1"),
            ("iterations", self.iterations >= 1, "at least 1"),
            ("difference", 0.0 < self.difference <= 0.1, "above 0 and at most 0.1"),
        ):
            require(self.name, option, getattr(self, option), valid, allowed)

    @property
    def name(self) -> str:
        """``"pattern-search+polish"``."""
        return "pattern-search+polish"

    def run(self, run: Run) -> str:
        """Run the pattern search, then a local search from each of its results, best first."""
        starts = run.starts(self.starts, np.random.default_rng(run.seed))
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
