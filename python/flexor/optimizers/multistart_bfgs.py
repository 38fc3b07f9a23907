"""Bounded quasi-Newton descents from several starts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import require
from flexor.optimizers.quasi_newton import descend


@dataclass(frozen=True)
class MultistartBfgs(Method):
    """L-BFGS-B (Byrd, Lu, Nocedal and Zhu 1995) from several starts, the best start first.

    With the function's exact gradient each step costs one design, whatever the number of
    parameters. A descent ends where the gradient vanishes or where the line search meets a break
    of the landscape (a snap, a sphere that slips off another); other starts are the answer to that.

    Attributes
    ----------
    starts : int
        Number of starts, the given ones included.
    tolerance : float
        Of the projected gradient in the unit box; its square of the decrease in one step.
    iterations : int
        At most so many steps from each start.
    difference : float
        Step of the differences where there is no exact gradient, as a fraction of the ranges.
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
        for option, inside, allowed in (
            ("starts", self.starts >= 1, "at least 1"),
            ("tolerance", 0.0 < self.tolerance < 1.0, "between 0 and 1"),
            ("iterations", self.iterations >= 1, "at least 1"),
            ("difference", 0.0 < self.difference <= 0.1, "above 0 and at most 0.1"),
        ):
            require(self.name, option, getattr(self, option), inside, allowed)

    @property
    def name(self) -> str:
        """``"multistart-bfgs"``."""
        return "multistart-bfgs"

    def run(self, run: Run) -> str:
        """Descend from one start after another."""
        points = run.starts(self.starts, np.random.default_rng(run.seed))
        values = run.values(points)
        run.step("starts")
        good = [i for i in np.argsort(values, kind="stable") if np.isfinite(values[i])]
        for i in good:
            descend(run, points[i], self.difference, self.tolerance, self.iterations)
        if not good:
            return "no start succeeded" if len(points) > 1 else "the start failed"
        return f"descents from {len(good)} starts ended"
