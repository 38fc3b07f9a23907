"""DIRECT, of SciPy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Method, Run
from flexor.optimizers.options import require

# SciPy's code cannot hold more rectangles than it is told to expect.
LARGEST = 200_000


@dataclass(frozen=True)
class Direct(Method):
    """Dividing rectangles (Jones 1993), locally biased by default (Gablonsky 2001).

    Deterministic: the seed has no part in it and the start is only evaluated, so that the method
    knows no less than the others. Designs are asked for one by one.

    Attributes
    ----------
    local : bool
        The locally biased variant, better where there are few local minima.
    side : float
        It ends when the rectangle of the best design is smaller than this in all directions, as a
        fraction of the ranges.
    gain : float
        A rectangle is divided only if it may improve the best value by more than this part of it
        (Jones's epsilon); smaller is more local.
    evaluations : int
        It ends after about so many evaluations if no budget ends it before.
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
        inside = 1 <= self.evaluations <= LARGEST
        require(self.name, "evaluations", self.evaluations, inside, f"from 1 to {LARGEST}")

    @property
    def name(self) -> str:
        """``"direct"``."""
        return "direct"

    def run(self, run: Run) -> str:
        """Divide until the rectangle is small."""
        from scipy.optimize import direct

        run.values(run.starts(1, np.random.default_rng(run.seed)))

        def value(point: FloatArray) -> float:
            return float(run.values(point[None, :])[0])

        def report(_: Any) -> None:
            run.step("dividing")

        k = run.size
        found = direct(
            value,
            [(0.0, 1.0)] * k,
            locally_biased=self.local,
            eps=self.gain,
            vol_tol=0.0,
            len_tol=self.side,
            maxfun=self.evaluations,
            maxiter=self.evaluations,
            callback=report,
        )
        if "side length" in str(found.message):
            return f"the best rectangle's sides are below {self.side:g}"
        return f"{run.function.evaluations} evaluations"
