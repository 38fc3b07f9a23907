"""Design variables that change neither the objective nor a constraint, as far as was tried."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexor.study.problem import FloatArray, Problem

# Values of a variable, from one bound to the other, at which a design is evaluated.
_ALONG = 7
# A share of the largest value, below which a change is one of rounding.
_ROUNDING = 1e-9


def ineffective(
    problem: Problem, designs: FloatArray, columns: NDArray[np.intp] | None = None
) -> tuple[str, ...]:
    """Find variables that may be anything within their bounds, at each of some designs.

    Each variable is moved from one bound to the other, first to these alone, with the others as in
    a design; with scenarios and errors in all of them.

    Parameters
    ----------
    problem
        The problem.
    designs : (n, k) array
        Designs, SI, such as the start and the optimum.
    columns : (c,) array, optional
        Of the k variables those that are tried; all by default.

    Returns
    -------
    tuple of str
        Their labels.
    """
    chosen = problem.parameters
    left = np.arange(chosen.size, dtype=np.intp) if columns is None else columns
    for shares in ((0.0, 1.0), np.linspace(0.0, 1.0, _ALONG)[1:-1]):
        for design in designs:
            if left.size:
                left = left[_unmoved(problem, design, left, np.asarray(shares))]
    return tuple(chosen.labels[i] for i in left)


def _unmoved(
    problem: Problem, design: FloatArray, columns: NDArray[np.intp], shares: FloatArray
) -> NDArray[np.bool_]:
    """Return which of some variables have no effect on a design (k,), a mask."""
    chosen = problem.parameters
    low, high = chosen.lower[columns], chosen.upper[columns]
    moved = np.repeat(design[None, :], len(columns) * len(shares), axis=0)
    rows = np.arange(len(moved)).reshape(len(columns), len(shares))
    moved[rows, columns[:, None]] = low[:, None] + shares * (high - low)[:, None]
    found = problem.evaluate(np.concatenate([design[None, :], moved]))
    objective = found.objective_values if problem.objective.count else found.value[:, None]
    # What cannot be evaluated is infinite or not a number, and equal to itself only.
    values = np.concatenate([objective, found.constraint_values], axis=1)
    with np.errstate(invalid="ignore"):
        largest = np.nanmax(np.abs(np.where(np.isfinite(values), values, np.nan)), axis=0)
    same = np.isclose(values[1:], values[0], rtol=0.0, atol=_ROUNDING * largest, equal_nan=True)
    unmoved: NDArray[np.bool_] = same.all(axis=1)[rows].all(axis=1)
    return unmoved
