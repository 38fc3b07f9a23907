"""Descent by bounded quasi-Newton steps (L-BFGS-B, of SciPy) within a run."""

from __future__ import annotations

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Run
from flexor.optimizers.unit_box import finite


def descend(
    run: Run, start: FloatArray, difference: float, tolerance: float, iterations: int
) -> FloatArray:
    """Descend from a point to where the gradient vanishes or the landscape breaks.

    Parameters
    ----------
    run : Run
        What is minimised, in the unit box; its exact gradient if it has one, else one batch of
        one-sided differences, turned inwards at an upper bound.
    start : (k,) array
        Where to begin; it must not have failed.
    difference : float
        Step of the differences.
    tolerance : float
        Of the projected gradient and of the relative decrease of the value in one step.
    iterations : int
        At most so many steps.

    Returns
    -------
    (k,) array
        Where it ended; the best point of the run may be another.
    """
    from scipy.optimize import minimize

    def value_and_slope(point: FloatArray) -> tuple[float, FloatArray]:
        value = float(run.values(point[None, :])[0])
        if not np.isfinite(value):
            return float(finite(np.array(value))), np.zeros(run.size)
        return value, slope(run, point, value, difference)

    found = minimize(
        value_and_slope,
        start,
        jac=True,
        method="L-BFGS-B",
        bounds=[(0.0, 1.0)] * run.size,
        options={"maxiter": iterations, "gtol": tolerance, "ftol": tolerance**2, "maxls": 10},
        callback=lambda _: run.step("quasi-Newton"),
    )
    end: FloatArray = np.asarray(found.x, dtype=np.float64)
    return end


def slope(run: Run, point: FloatArray, value: float, difference: float) -> FloatArray:
    """Gradient (k,) at a point whose value is known; zero where it is not finite."""
    exact = run.gradient(point[None, :])
    if exact is not None:
        return np.where(np.isfinite(exact[0]), exact[0], 0.0)
    steps = np.where(point + difference > 1.0, -difference, difference)
    around = run.values(point + np.diag(steps))
    rise = np.where(np.isfinite(around), around - value, 0.0) / steps
    return np.asarray(rise)
