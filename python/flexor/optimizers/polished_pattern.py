"""Pattern search on a coarse mesh, then descents by the gradient from what it found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import require
from flexor.optimizers.pattern import PatternSearch
from flexor.optimizers.quasi_newton import descend


@dataclass(frozen=True)
class PolishedPattern(Method):
    """Generalised pattern search down to a coarse mesh, and L-BFGS-B from the end of each start.

    The polls see over the bumps of a landscape, the gradient finds the bottom of the one that
    they chose.

    Attributes
    ----------
    starts : int
        Number of starts, the given ones included.
    initial_mesh, mesh : float
        First mesh of the pattern search, and the one below which it hands over, as fractions of
        the ranges.
    tolerance : float
        Of the projected gradient in the unit box; its square of the decrease in one step.
    iterations : int
        At most so many steps of each descent.
    difference : float
        Step of the differences where there is no exact gradient, as a fraction of the ranges.
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
        for option, inside, allowed in (
            ("starts", self.starts >= 1, "at least 1"),
            ("initial_mesh", 0.0 < self.initial_mesh <= 1.0, "above 0 and at most 1"),
            ("mesh", 0.0 < self.mesh < 1.0, "between 0 and 1"),
            ("tolerance", 0.0 < self.tolerance < 1.0, "between 0 and 1"),
            ("iterations", self.iterations >= 1, "at least 1"),
            ("difference", 0.0 < self.difference <= 0.1, "above 0 and at most 0.1"),
        ):
            require(self.name, option, getattr(self, option), inside, allowed)

    @property
    def name(self) -> str:
        """``"pattern-search+polish"``."""
        return "pattern-search+polish"

    def run(self, run: Run) -> str:
        """Poll, then descend from the best of every start, the best of all first."""
        starts = run.starts(self.starts, np.random.default_rng(run.seed))
        coarse = PatternSearch(initial_mesh=self.initial_mesh, tolerance=self.mesh)
        polls = []
        box = np.zeros(run.size), np.ones(run.size)
        for polls in coarse.iterate(run.values, *box, start=starts, seed=run.seed):
            run.step(f"mesh {max(poll.mesh for poll in polls):.3g}")
        found = sorted((p for p in polls if np.isfinite(p.value)), key=lambda poll: poll.value)
        for poll in found:
            descend(run, poll.design, self.difference, self.tolerance, self.iterations)
        if not found:
            return "no start succeeded" if self.starts > 1 else "the start failed"
        return f"polished at a mesh of {self.mesh:g}"
