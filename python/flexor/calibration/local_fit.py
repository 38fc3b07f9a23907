"""The local fit: bounded least squares."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.arrays import Array
from flexor.calibration.evaluator import Evaluator

_FAILED_RESIDUAL = 1e4  # residual of a failed path, so that the step is rejected
_MAX_EVALUATIONS = 40  # of the residuals, besides those for derivatives
_MAX_EVALUATIONS_WITH_OPTIMA = 20
_BOUND_MARGIN = 1e-9  # between the start of least squares and the bounds
_TARGET_MISFIT = 0.01  # at which a fit with optima ends: a tenth of a standard deviation


@dataclass(frozen=True, eq=False)
class Minimum:
    """Result of a local fit."""

    u: Array  # (c,), in the unit cube
    residuals: Array  # (r,)
    hits: int = 1  # how many starts ended here

    @property
    def misfit(self) -> float:
        """Sum of squares."""
        return float(self.residuals @ self.residuals)


def fit_locally(evaluator: Evaluator, start: Array, fixed: tuple[int, ...] = ()) -> Minimum:
    """Fit from a start (c,), with some coordinates fixed; at least as good as the start.

    Notes
    -----
    Trust-region reflective least squares (Branch, Coleman and Li 1999) in the unit cube, with
    central differences. If optima are among the targets, the paths are fitted first, which covers
    most of the distance without a search for an optimum.
    """
    free = [i for i in range(len(start)) if i not in fixed]
    problem = evaluator.problem
    evaluations = _MAX_EVALUATIONS
    if problem.needs_optima:
        if problem.path_runs:
            start = _least_squares(evaluator, start, free, problem.path_runs, _MAX_EVALUATIONS)
        evaluations = _MAX_EVALUATIONS_WITH_OPTIMA
    u = _least_squares(evaluator, start, free, problem.fitted_runs, evaluations)
    found = evaluator.residuals(u[None, :], problem.fitted_runs, threads=1)[0]
    return Minimum(u, np.asarray(np.nan_to_num(found, nan=_FAILED_RESIDUAL)))


def _least_squares(
    evaluator: Evaluator, start: Array, free: list[int], runs: tuple[int, ...], evaluations: int
) -> Array:
    from scipy.optimize import least_squares

    with_optima = runs != evaluator.problem.path_runs

    def point(v: Array) -> Array:
        u = start.copy()
        u[free] = np.clip(v, 0.0, 1.0)
        return u

    def residuals(v: Array) -> Array:
        found = evaluator.residuals(point(v)[None, :], runs, threads=1)[0]
        found = np.asarray(np.nan_to_num(found, nan=_FAILED_RESIDUAL))
        if with_optima and float(found @ found) < _TARGET_MISFIT:
            raise _TargetMisfitReached(point(v))
        return found

    if not free:
        return start
    try:
        ended = least_squares(
            residuals,
            np.clip(start[free], _BOUND_MARGIN, 1.0 - _BOUND_MARGIN),
            jac=lambda v: np.nan_to_num(evaluator.jacobian(point(v), free, runs)),
            bounds=(0.0, 1.0),
            ftol=1e-10,
            xtol=1e-10,
            gtol=1e-12,
            max_nfev=evaluations,
        )
    except _TargetMisfitReached as good:
        return good.u
    return point(ended.x)


class _TargetMisfitReached(Exception):
    """Leaves a fit at a point that is good enough."""

    def __init__(self, u: Array) -> None:
        self.u = u


def distinct(minima: list[Minimum], apart: float = 0.02) -> list[Minimum]:
    """Merge minima that differ by no more than a part of any range; the best first."""
    found: list[Minimum] = []
    for minimum in sorted(minima, key=lambda m: m.misfit):
        for i, kept in enumerate(found):
            if np.max(np.abs(kept.u - minimum.u)) <= apart:
                found[i] = Minimum(kept.u, kept.residuals, kept.hits + minimum.hits)
                break
        else:
            found.append(minimum)
    return found
