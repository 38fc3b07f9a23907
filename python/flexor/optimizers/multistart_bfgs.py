"""Bounded quasi-Newton searches from several starts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run, penalize_failures
from flexor.optimizers.options import FRACTION, at_least, at_most, option


@dataclass(frozen=True)
class MultistartBfgs(Method):
    """L-BFGS-B (Byrd, Lu, Nocedal and Zhu 1995) from several starts, the best start first.

    With an exact gradient each step costs one design, independent of the number of parameters. A
    local search ends where the gradient vanishes or where the line search fails at a
    discontinuity of the objective (a snap, a lost contact); use several starts to escape these.

    Attributes
    ----------
    starts : int
        Number of starts, including the given ones.
    tolerance : float
        Tolerance of the projected gradient in the unit box; its square is the tolerance of the
        relative decrease in one step.
    iterations : int
        Maximum number of iterations from each start.
    difference : float
        Finite-difference step where there is no exact gradient, as a fraction of the ranges.
    """

    name = "multistart-bfgs"
    title = "multi-start BFGS"
    aliases = ("bfgs", "l-bfgs-b")
    description = "local quasi-Newton searches with exact gradients from several starts"
    packages = ("scipy",)
    gradients: ClassVar[bool] = True

    starts: int = option(8, at_least(1))
    tolerance: float = option(1e-6, FRACTION)
    iterations: int = option(100, at_least(1))
    difference: float = option(1e-6, at_most(0.1))

    def run(self, run: Run) -> str:
        """Run a local search from each start in turn."""
        points = run.starts(self.starts)
        values = run.values(points)
        run.step("starts")
        valid = [i for i in np.argsort(values, kind="stable") if np.isfinite(values[i])]
        for i in valid:
            minimize_lbfgsb(run, points[i], self.difference, self.tolerance, self.iterations)
        if not valid:
            return "no start succeeded" if len(points) > 1 else "the start failed"
        return f"local searches from {len(valid)} starts ended"


def minimize_lbfgsb(
    run: Run, start: FloatArray, difference: float, tolerance: float, iterations: int
) -> FloatArray:
    """Run L-BFGS-B in the unit box from a point (k,) of finite value; return where it ends (k,).

    It ends where the gradient vanishes or the line search fails, not necessarily at the best point
    of the run. Without an exact gradient, differences are taken.
    """
    from scipy.optimize import minimize

    def value_and_gradient(point: FloatArray) -> tuple[float, FloatArray]:
        value = float(run.values(point[None, :])[0])
        if not np.isfinite(value):
            return float(penalize_failures(np.array(value))), np.zeros(run.size)
        exact = run.gradient(point[None, :])
        if exact is None:
            return value, difference_gradient(run, point, difference)
        return value, np.where(np.isfinite(exact[0]), exact[0], 0.0)

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


def difference_gradient(run: Run, point: FloatArray, difference: float) -> FloatArray:
    """Return the gradient (k,) at a point by one batch of one-sided differences.

    They are taken backwards at an upper bound, and zero where they are not finite.
    """
    steps = np.where(point + difference > 1.0, -difference, difference)
    values = run.values(np.concatenate((point[None, :], point + np.diag(steps))))
    with np.errstate(invalid="ignore"):
        rise = (values[1:] - values[0]) / steps
    return np.where(np.isfinite(rise), rise, 0.0)
