"""A sample of the whole box, sequential quadratic programming from its best, a pattern search."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import FRACTION, at_least, at_most, option
from flexor.optimizers.pattern import PatternSearch
from flexor.optimizers.sqp import linearization, minimize_slsqp


@dataclass(frozen=True)
class Auto(Method):
    """Sobol sample, SLSQP (Kraft 1988) with the constraints from its best designs, pattern search.

    The sample finds the valley, SLSQP its floor along the constraints, and the pattern search what
    lies beyond a snap or a lost contact, where slopes say nothing. Slopes of values and constraints
    are exact; where one of these has no derivative, they are one-sided differences, one batch for
    each.

    Attributes
    ----------
    samples : int
        Number of designs of the sample, besides the given starts.
    starts : int
        Number of designs from which SLSQP begins.
    iterations : int
        Maximum number of iterations of each.
    difference : float
        Step of the differences, as a fraction of the ranges.
    mesh, tolerance : float
        Initial and final mesh size of the pattern search, likewise.
    """

    name = "auto"
    title = "sample, SQP and pattern search"
    description = "Sobol sample, SQP with constraints from its best, then pattern search"
    packages = ("scipy",)

    samples: int = option(128, at_least(1))
    starts: int = option(3, at_least(1))
    iterations: int = option(30, at_least(1))
    difference: float = option(1e-5, at_most(0.1))
    mesh: float = option(0.02, FRACTION)
    tolerance: float = option(1e-4, FRACTION)

    @property
    def local(self) -> Auto:
        """The same from a start that is nearly optimal: without a sample."""
        return replace(self, samples=1, starts=1)

    def run(self, run: Run) -> str:
        """Sample, run SLSQP from the best of it, and a pattern search from the best of all."""
        from scipy.stats import qmc

        size = 1 << (self.samples - 1).bit_length()
        sample = qmc.Sobol(run.size, scramble=True, seed=run.seed).random(size)[: self.samples]
        points = np.concatenate((run.starts(0), sample))
        values = run.values(points)
        run.step("sample")
        order = [i for i in np.argsort(values, kind="stable") if np.isfinite(values[i])]
        if not order:
            return "no design of the sample succeeded"
        ends = [(values[order[0]], points[order[0]])]
        for i in order[: self.starts]:
            end = minimize_slsqp(
                run,
                points[i],
                lambda point: linearization(run, point, self.difference),
                self.iterations,
            )
            ends.append((float(run.values(end[None, :])[0]), end))
        best = min(ends, key=lambda each: each[0])[1]
        search = PatternSearch(initial_mesh=self.mesh, tolerance=self.tolerance)
        box = np.zeros(run.size), np.ones(run.size)
        for polls in search.iterate(run.values, *box, start=best, seed=run.seed):
            run.step(f"mesh {max(poll.mesh for poll in polls):.3g}")
        return f"the mesh is below {self.tolerance:g}"
