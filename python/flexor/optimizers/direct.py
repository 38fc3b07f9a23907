"""DIRECT, from SciPy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import FRACTION, Range, option

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

    name = "direct"
    title = "DIRECT"
    description = "dividing rectangles; deterministic"
    packages = ("scipy",)

    local: bool = True
    side: float = option(1e-4, FRACTION)
    gain: float = option(1e-4, FRACTION)
    evaluations: int = option(
        5_000, Range(lambda value: 1 <= value <= MAX_EVALUATIONS, f"from 1 to {MAX_EVALUATIONS}")
    )

    def run(self, run: Run) -> str:
        """Divide until the best rectangle is small."""
        from scipy.optimize import direct

        run.values(run.starts(1))

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
