"""Local search with L-BFGS-B from SciPy."""

from __future__ import annotations

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Run
from flexor.optimizers.unit_box import penalize_failures


def minimize_lbfgsb(
    run: Run, start: FloatArray, difference: float, tolerance: float, iterations: int
) -> FloatArray:
    """Run L-BFGS-B from a point until the gradient vanishes or the line search fails.

    Parameters
    ----------
    run : Run
        The function to minimise in the unit box. Its exact gradient is used if available, else
        one batch of one-sided differences, taken backwards at an upper bound.
    start : (k,) array
        Starting point; its value must be finite.
    difference : float
        Finite-difference step.
    tolerance : float
        Tolerance of the projected gradient; its square is that of the relative decrease in one
        step.
    iterations : int
        Maximum number of iterations.

    Returns
    -------
    (k,) array
        Final point, not necessarily the best one of the run.
    """
    from scipy.optimize import minimize

    def value_and_gradient(point: FloatArray) -> tuple[float, FloatArray]:
        value = float(run.values(point[None, :])[0])
        if not np.isfinite(value):
            return float(penalize_failures(np.array(value))), np.zeros(run.size)
        return value, gradient(run, point, value, difference)

    result = minimize(
        value_and_gradient,
        start,
        jac=True,
        method="L-BFGS-B",
        bounds=[(0.0, 1.0)] * run.size,
        options={"maxiter": iterations, "gtol": tolerance, "ftol": tolerance**2, "maxls": 10},
        callback=lambda _: run.step("quasi-Newton"),
    )
    end: FloatArray = np.asarray(result.x, dtype=np.float64)
    return end


def gradient(run: Run, point: FloatArray, value: float, difference: float) -> FloatArray:
    """Return the gradient (k,) at a point of known value, with zeros where it is not finite."""
    exact = run.gradient(point[None, :])
    if exact is not None:
        return np.where(np.isfinite(exact[0]), exact[0], 0.0)
    steps = np.where(point + difference > 1.0, -difference, difference)
    around = run.values(point + np.diag(steps))
    rise = np.where(np.isfinite(around), around - value, 0.0) / steps
    return np.asarray(rise)
