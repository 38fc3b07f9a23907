"""A value of Flexor against one that Flexor had no part in."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Comparison:
    """A quantity with its unit, its reference and Flexor's value.

    Of arrays, `reference` and `ours` are the entries that differ most, and `count` is their size.
    `error` is the largest deviation over the scale of the quantity; for words it is 0 if they
    agree and infinite if not.
    """

    quantity: str
    reference: float | str
    ours: float | str
    error: float
    tolerance: float
    count: int = 1

    @property
    def passed(self) -> bool:
        """Whether the error is within the tolerance; NaN is not."""
        return self.error <= self.tolerance

    @property
    def share(self) -> float:
        """How much of the tolerance is used."""
        if self.tolerance > 0.0:
            return self.error / self.tolerance
        return 0.0 if self.passed else math.inf

    @property
    def cells(self) -> tuple[str, str, str, str]:
        """Reference, Flexor's value, error and tolerance as the report shows them."""
        if isinstance(self.reference, str):
            return self.reference, str(self.ours), "", ""
        reference, ours = (
            "0" if value == 0.0 else f"{float(value):.10g}" for value in (self.reference, self.ours)
        )
        return reference, ours, f"{self.error:.1e}", f"{self.tolerance:.2g}"


def compare(
    quantity: str,
    reference: ArrayLike,
    ours: ArrayLike,
    tolerance: float,
    scale: float | None = None,
) -> Comparison:
    """Compare numbers, or arrays of the same shape.

    Deviations are divided by `scale`, the largest reference value unless given. Raises ValueError
    if shapes differ or there is no scale: a comparison that could not fail.
    """
    wanted, found = np.asarray(reference, dtype=float), np.asarray(ours, dtype=float)
    if wanted.shape != found.shape or wanted.size == 0:
        raise ValueError(f"{quantity}: shapes {wanted.shape} and {found.shape} do not compare")
    scale = float(np.max(np.abs(wanted))) if scale is None else float(scale)
    if not (scale > 0.0 and math.isfinite(scale)):
        raise ValueError(f"{quantity}: a scale of {scale} measures nothing")
    deviation = np.abs(found - wanted) / scale
    # argmax takes the first NaN for the largest, so that it is shown and fails.
    worst = np.unravel_index(int(np.argmax(deviation)), deviation.shape)
    return Comparison(
        quantity=quantity,
        reference=float(wanted[worst]),
        ours=float(found[worst]),
        error=float(deviation[worst]),
        tolerance=tolerance,
        count=wanted.size,
    )


def verdict(quantity: str, reference: str, ours: str) -> Comparison:
    """Compare words, such as "stable" with "unstable"."""
    return Comparison(quantity, reference, ours, 0.0 if reference == ours else math.inf, 0.0)


def at_least(quantity: str, expected: float, found: float, slack: float) -> Comparison:
    """Demand that a number, such as an order of convergence, is not below `expected - slack`."""
    short = expected - found
    error = short if math.isnan(short) else max(short, 0.0)
    return Comparison(f"{quantity}, at least", expected, float(found), error, slack)
