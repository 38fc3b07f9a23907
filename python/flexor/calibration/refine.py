"""The local fit: bounded least squares."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexor.calibration.evaluate import Evaluator

Array = NDArray[np.float64]
_FAILED = 1e4  # residual of a path that failed, to be stepped back from
_MOST = 40  # evaluations of the residuals, besides those for derivatives
_MOST_DEAR = 20  # where each needs a search
_INSIDE = 1e-9  # least squares starts inside the bounds
_CLOSE = 0.01  # misfit at which a fit that needs searches is good: a tenth of a deviation


@dataclass(frozen=True, eq=False)
class Minimum:
    """Where a local fit ended.

    Attributes
    ----------
    u : (f,) array
        Point of the unit cube.
    residuals : (r,) array
        There.
    hits : int
        How many starts ended here.
    """

    u: Array
    residuals: Array
    hits: int = 1

    @property
    def misfit(self) -> float:
        """Sum of squares."""
        return float(self.residuals @ self.residuals)


def refine(evaluator: Evaluator, start: Array, held: tuple[int, ...] = ()) -> Minimum:
    """Fit from one start.

    Parameters
    ----------
    evaluator : Evaluator
        Of the variant.
    start : (f,) array
        Point of the unit cube.
    held : tuple of int
        Coordinates that stay as they are.

    Returns
    -------
    Minimum
        At least as good as the start.

    Notes
    -----
    Trust-region reflective least squares (Branch, Coleman and Li 1999) in the unit cube, with
    central differences. Where optima are among the targets, the
    paths are fitted first, which takes the long way without any search for an optimum.
    """
    free = [i for i in range(len(start)) if i not in held]
    variant = evaluator.variant
    if variant.dear and variant.path_runs:
        start = _fitted(evaluator, start, free, variant.path_runs, _MOST)
    u = _fitted(evaluator, start, free, variant.fitted_runs, _MOST_DEAR if variant.dear else _MOST)
    found = evaluator.residuals(u[None, :], variant.fitted_runs, threads=1)[0]
    return Minimum(u, np.asarray(np.nan_to_num(found, nan=_FAILED)))


def _fitted(
    evaluator: Evaluator, start: Array, free: list[int], runs: tuple[int, ...], most: int
) -> Array:
    from scipy.optimize import least_squares

    def point(v: Array) -> Array:
        u = start.copy()
        u[free] = np.clip(v, 0.0, 1.0)
        return u

    dear = runs != evaluator.variant.path_runs

    def residuals(v: Array) -> Array:
        found = evaluator.residuals(point(v)[None, :], runs, threads=1)[0]
        found = np.asarray(np.nan_to_num(found, nan=_FAILED))
        if dear and float(found @ found) < _CLOSE:
            raise _Close(point(v))
        return found

    if not free:
        return start
    try:
        ended = least_squares(
            residuals,
            np.clip(start[free], _INSIDE, 1.0 - _INSIDE),
            jac=lambda v: np.nan_to_num(evaluator.slopes(point(v), free, runs)),
            bounds=(0.0, 1.0),
            ftol=1e-10,
            xtol=1e-10,
            gtol=1e-12,
            max_nfev=most,
        )
    except _Close as close:
        return close.u
    return point(ended.x)


class _Close(Exception):
    """Raised out of a fit that is good enough."""

    def __init__(self, u: Array) -> None:
        self.u = u


def distinct(minima: list[Minimum], apart: float = 0.02) -> list[Minimum]:
    """Join minima that are one: those nowhere further apart than a part of the ranges.

    Parameters
    ----------
    minima : list of Minimum
        As the local fits ended.
    apart : float
        Fraction of a range.

    Returns
    -------
    list of Minimum
        The best first, with their hits added up.
    """
    found: list[Minimum] = []
    for minimum in sorted(minima, key=lambda m: m.misfit):
        same = next(
            (i for i, m in enumerate(found) if np.max(np.abs(m.u - minimum.u)) <= apart), None
        )
        if same is None:
            found.append(minimum)
        else:
            kept = found[same]
            found[same] = Minimum(kept.u, kept.residuals, kept.hits + minimum.hits)
    return found
