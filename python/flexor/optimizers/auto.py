"""A sample of the whole box, sequential quadratic programming from its best, a pattern search."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import FRACTION, at_least, at_most, option
from flexor.optimizers.pattern import PatternSearch


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
            end = self._descend(run, points[i])
            ends.append((float(run.values(end[None, :])[0]), end))
        best = min(ends, key=lambda each: each[0])[1]
        search = PatternSearch(initial_mesh=self.mesh, tolerance=self.tolerance)
        box = np.zeros(run.size), np.ones(run.size)
        for polls in search.iterate(run.values, *box, start=best, seed=run.seed):
            run.step(f"mesh {max(poll.mesh for poll in polls):.3g}")
        return f"the mesh is below {self.tolerance:g}"

    def _descend(self, run: Run, start: FloatArray) -> FloatArray:
        """Run SLSQP from a point (k,) and return where it ends."""
        from scipy.optimize import minimize

        seen: dict[bytes, tuple[float, FloatArray, FloatArray, FloatArray]] = {}

        def at(point: FloatArray) -> tuple[float, FloatArray, FloatArray, FloatArray]:
            key = point.tobytes()
            if key not in seen:
                seen[key] = self._linearized(run, np.clip(point, 0.0, 1.0))
            return seen[key]

        bounds = {
            "type": "ineq",
            "fun": lambda point: -at(point)[2] - _MARGIN,
            "jac": lambda point: -at(point)[3],
        }
        result = minimize(
            lambda point: at(point)[:2],
            start,
            jac=True,
            method="SLSQP",
            bounds=[(0.0, 1.0)] * run.size,
            constraints=[bounds] if at(start)[2].size else [],
            options={"maxiter": self.iterations, "ftol": 1e-9},
            callback=lambda _: run.step("SQP"),
        )
        return np.clip(np.asarray(result.x, dtype=np.float64), 0.0, 1.0)

    def _linearized(
        self, run: Run, point: FloatArray
    ) -> tuple[float, FloatArray, FloatArray, FloatArray]:
        """Return value, gradient (k,), excesses (c,) and their Jacobian (c, k) at a point (k,)."""
        exact = run.linearized(point[None, :])
        if exact is not None:
            found, excess, slopes, rises = (each[0] for each in exact)
            value = float(found) if np.isfinite(found) else _FAILED
            return value, _finite(slopes), np.nan_to_num(excess, nan=1.0), _finite(rises)
        steps = np.where(point + self.difference > 1.0, -self.difference, self.difference)
        values, excesses = run.constrained(np.concatenate((point[None, :], point + np.diag(steps))))
        with np.errstate(invalid="ignore"):
            slope = (values[1:] - values[0]) / steps
            rise = ((excesses[1:] - excesses[0]) / steps[:, None]).T
        # A failed design is worse than any, and has no slope.
        value = float(values[0]) if np.isfinite(values[0]) else _FAILED
        return value, _finite(slope), np.nan_to_num(excesses[0], nan=1.0), _finite(rise)


# Of the bounds, by which SLSQP keeps away: it holds constraints to its accuracy only.
_MARGIN = 1e-8
# Value of a design that failed: worse than any.
_FAILED = 1e6


def _finite(slopes: FloatArray) -> FloatArray:
    return np.where(np.isfinite(slopes), slopes, 0.0)
