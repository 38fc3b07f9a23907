"""DIRECT, from SciPy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import require

# SciPy allocates its rectangles in advance.
MAX_EVALUATIONS = 200_000


@dataclass(frozen=True)
class Direct(Method):
    """Dividing rectangles (Jones 1993), locally biased by default (Gablonsky 2001).

    Deterministic: the seed has no effect. The start is evaluated, for a fair comparison with the
    other methods, but not used. Designs are evaluated one at a time.

    Attributes
    ----------
    local : bool
        Use the locally biased variant, better for problems with few local minima.
    side : float
        Stop when the sides of the best rectangle, as fractions of the ranges, are all below this.
    gain : float
        Minimal relative improvement that a rectangle must promise to be divided (Jones's
        epsilon); smaller is more local.
    evaluations : int
        Approximate evaluation limit if no budget is given.
    """

    local: bool = True
    side: float = 1e-4
    gain: float = 1e-4
    evaluations: int = 5_000

    def __post_init__(self) -> None:
        """Check the options.

        Raises
        ------
        InputError
            If one is out of its range.
        """
        require(self.name, "side", self.side, 0.0 < self.side < 1.0, "between 0 and 1")
        require(self.name, "gain", self.gain, 0.0 < self.gain < 1.0, "between 0 and 1")
        valid = 1 <= self.evaluations <= MAX_EVALUATIONS
        require(self.name, "evaluations", self.evaluations, valid, f"from 1 to {MAX_EVALUATIONS}")

    @property
    def name(self) -> str:
        """``"direct"``."""
        return "direct"

    def run(self, run: Run) -> str:
        """Divide until the best rectangle is small."""
        from scipy.optimize import direct

        run.values(run.starts(1, np.random.default_rng(run.seed)))

        def value(point: FloatArray) -> float:
            return float(run.values(point[None, :])[0])

        def callback(_: Any) -> None:
            run.step("dividing")

        k = run.size
        result = direct(
            value,
            [(0.0, 1.0)] * k,
            locally_biased=self.local,
            eps=self.gain,
            vol_tol=0.0,
            len_tol=self.side,
            maxfun=self.evaluations,
            maxiter=self.evaluations,
            callback=callback,
        )
        if "side length" in str(result.message):
            return f"the best rectangle's sides are below {self.side:g}"
        return f"{run.function.evaluations} evaluations"
