"""The local fit: bounded least squares, and the derivatives it needs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexor.calibrate.evaluate import Evaluator

Array = NDArray[np.float64]
_STEP = 1e-3  # of a range: wider than the roughness of sphere contacts, narrower than their effect
_FAILED = 1e4  # residual of a path that failed, to be stepped back from
_MOST = 40  # evaluations of the residuals, besides those for derivatives
_INSIDE = 1e-9  # least squares starts inside the bounds


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
    central differences over a thousandth of each range.
    """
    from scipy.optimize import least_squares

    free = [i for i in range(len(start)) if i not in held]

    def point(v: Array) -> Array:
        u = start.copy()
        u[free] = np.clip(v, 0.0, 1.0)
        return u

    def residuals(v: Array) -> Array:
        found = evaluator.residuals(point(v)[None, :], threads=1)[0]
        return np.asarray(np.nan_to_num(found, nan=_FAILED))

    if not free:
        return Minimum(start, residuals(np.empty(0)))
    ended = least_squares(
        residuals,
        np.clip(start[free], _INSIDE, 1.0 - _INSIDE),
        jac=lambda v: np.nan_to_num(jacobian(evaluator, point(v), free)),
        bounds=(0.0, 1.0),
        ftol=1e-10,
        xtol=1e-10,
        gtol=1e-12,
        max_nfev=_MOST,
    )
    return Minimum(point(ended.x), np.asarray(ended.fun))


def jacobian(evaluator: Evaluator, u: Array, free: list[int] | None = None) -> Array:
    """Differentiate the residuals at a point (f,) by central differences.

    Returns
    -------
    (r, k) array
        By the k coordinates named, or all.
    """
    columns = list(range(len(u))) if free is None else free
    points = np.repeat(u[None, :], 2 * len(columns), axis=0)
    for row, column in enumerate(columns):
        points[2 * row, column] = min(u[column] + _STEP, 1.0)
        points[2 * row + 1, column] = max(u[column] - _STEP, 0.0)
    found = evaluator.residuals(points, threads=1)
    widths = [points[2 * r, c] - points[2 * r + 1, c] for r, c in enumerate(columns)]
    slopes = np.stack(
        [(found[2 * r] - found[2 * r + 1]) / width for r, width in enumerate(widths)], axis=1
    )
    return np.asarray(slopes)


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
