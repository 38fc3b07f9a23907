"""Levenberg-Marquardt on the objective's residual vector, the paper's least squares ("LS")."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import FRACTION, Range, at_least, at_most, option

MAX_DAMPING = 1e12
MIN_DAMPING = 1e-12


@dataclass
class LocalSearch:
    """State of the search from one start."""

    point: FloatArray  # (k,): current point in the unit box
    vector: FloatArray  # (r,): residual vector; NaN if the design failed
    damping: float  # of the next step
    # (r, k): Jacobian at the point, in the unit box; None if not yet evaluated.
    jacobian: FloatArray | None = None
    done: str = ""  # why the search has ended, or empty


@dataclass(frozen=True)
class LevenbergMarquardt(Method):
    """Nonlinear least squares on the objective's residual vector, such as q_b of f_b (13).

    Each iteration solves (J^T J + damping I) step = -J^T r in the unit box for the parameters
    that are not at an active bound, clips the step to the bounds and evaluates it. The damping is
    divided by 10 if the step reduces the norm and multiplied by 10 otherwise, as in the toolbox
    used by the paper. J is the exact Jacobian if available, else one-sided finite differences,
    taken backwards at an upper bound; a parameter whose difference fails is held for that
    iteration.

    Searches from several starts run in parallel: their steps form one batch, and so do their
    differences.

    Attributes
    ----------
    starts : int
        Number of starts, including the given ones.
    difference : float
        Finite-difference step as a fraction of each parameter's range. It should exceed the
        square root of the solver's precision and be small against the wavelength of the
        objective's oscillations.
    damping : float
        Initial damping.
    tolerance : float
        A search ends when its step, as a fraction of the ranges, or the gradient of the norm falls
        below this.
    iterations : int
        Maximum number of iterations.
    """

    name = "levenberg-marquardt"
    title = "Levenberg-Marquardt"
    aliases = ("lm", "ls", "least-squares")
    description = "the paper's LS: local nonlinear least squares on the objective's residual vector"
    gradients: ClassVar[bool] = True

    starts: int = option(1, at_least(1))
    difference: float = option(1e-6, at_most(0.1))
    damping: float = option(1e-2, Range(lambda value: 0.0 < value < np.inf, "above 0"))
    tolerance: float = option(1e-6, FRACTION)
    iterations: int = option(400, at_least(1))

    def run(self, run: Run) -> str:
        """Iterate until the search from every start has ended."""
        points = run.starts(self.starts)
        searches = [
            LocalSearch(
                point, vector, self.damping, done="" if np.isfinite(vector).all() else "failed"
            )
            for point, vector in zip(points, run.residuals(points), strict=True)
        ]
        run.step("start")
        for _ in range(self.iterations):
            active = [each for each in searches if not each.done]
            if not active:
                break
            self._differentiate(run, [each for each in active if each.jacobian is None])
            trials = [(each, self._trial_point(each)) for each in active]
            pending = [(each, trial) for each, trial in trials if trial is not None]
            if pending:
                vectors = run.residuals(np.array([trial for _, trial in pending]))
                for (each, trial), vector in zip(pending, vectors, strict=True):
                    self._update(each, trial, vector)
            run.step(f"damping {max(each.damping for each in active):.1g}")
        ends = [each.done or f"{self.iterations} iterations" for each in searches]
        if all(end == "failed" for end in ends):
            return "no start succeeded" if len(ends) > 1 else "the start failed"
        return "; ".join(dict.fromkeys(end for end in ends if end != "failed"))

    def _differentiate(self, run: Run, searches: list[LocalSearch]) -> None:
        if not searches:
            return
        points = np.array([each.point for each in searches])
        jacobians = run.jacobian(points)
        if jacobians is None:
            k = run.size
            signs = np.where(points + self.difference > 1.0, -1.0, 1.0)
            shifted = points[:, None, :] + self.difference * signs[:, None, :] * np.eye(k)
            vectors = run.residuals(shifted.reshape(-1, k)).reshape(len(points), k, -1)
            change = vectors - np.array([each.vector for each in searches])[:, None, :]
            jacobians = np.swapaxes(change / (self.difference * signs[:, :, None]), 1, 2)
        for each, jacobian in zip(searches, jacobians, strict=True):
            each.jacobian = np.where(np.isfinite(jacobian).all(axis=0), jacobian, 0.0)

    def _trial_point(self, each: LocalSearch) -> FloatArray | None:
        """Return the next trial point, or None if the search has converged."""
        assert each.jacobian is not None
        slope = each.jacobian.T @ each.vector
        active = ((each.point <= 0.0) & (slope > 0.0)) | ((each.point >= 1.0) & (slope < 0.0))
        free = np.flatnonzero(~active)
        gradient = np.linalg.norm(slope[free]) / max(float(np.linalg.norm(each.vector)), 1e-300)
        if gradient < self.tolerance:
            each.done = f"the gradient is below {self.tolerance:g}"
            return None
        columns = each.jacobian[:, free]
        normal = columns.T @ columns + each.damping * np.eye(free.size)
        trial = each.point.copy()
        trial[free] = np.clip(trial[free] - np.linalg.solve(normal, slope[free]), 0.0, 1.0)
        if np.linalg.norm(trial - each.point) < self.tolerance or each.damping > MAX_DAMPING:
            each.done = f"the step is below {self.tolerance:g}"
            return None
        return trial

    def _update(self, each: LocalSearch, trial: FloatArray, vector: FloatArray) -> None:
        # The comparison is false for the NaN of a failed design too.
        if np.linalg.norm(vector) < np.linalg.norm(each.vector):
            each.point, each.vector, each.jacobian = trial, vector, None
            each.damping = max(each.damping / 10.0, MIN_DAMPING)
        else:
            each.damping *= 10.0
