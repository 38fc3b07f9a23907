"""Bounded quasi-Newton searches from several starts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import require
from flexor.optimizers.quasi_newton import minimize_lbfgsb


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

    gradients: ClassVar[bool] = True

    starts: int = 8
    tolerance: float = 1e-6
    iterations: int = 100
    difference: float = 1e-6

    def __post_init__(self) -> None:
        """Check the options.

        Raises
        ------
        InputError
            If one is out of its range.
        """
        for option, valid, allowed in (
            ("starts", self.starts >= 1, "at least 1"),
            ("tolerance", 0.0 < self.tolerance < 1.0, "between 0 and 1"),
            ("iterations", self.iterations >= 1, "at least 1"),
            ("difference", 0.0 < self.difference <= 0.1, "above 0 and at most 0.1"),
        ):
            require(self.name, option, getattr(self, option), valid, allowed)

    @property
    def name(self) -> str:
        """``"multistart-bfgs"``."""
        return "multistart-bfgs"

    def run(self, run: Run) -> str:
        """Run a local search from each start in turn."""
        points = run.starts(self.starts, np.random.default_rng(run.seed))
        values = run.values(points)
        run.step("starts")
        valid = [i for i in np.argsort(values, kind="stable") if np.isfinite(values[i])]
        for i in valid:
            minimize_lbfgsb(run, points[i], self.difference, self.tolerance, self.iterations)
        if not valid:
            return "no start succeeded" if len(points) > 1 else "the start failed"
        return f"local searches from {len(valid)} starts ended"
