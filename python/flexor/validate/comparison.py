"""One number of Flexor against one that Flexor had no part in."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Comparison:
    """A quantity, its reference and Flexor's value.

    Attributes
    ----------
    quantity : str
        What is compared, with its unit.
    reference, ours : float or str
        The two values; of an array the entries that differ most. Words where a verdict is compared.
    error : float
        Largest deviation divided by the scale of the quantity (NaN if one value is NaN); for words
        0 if they agree and infinity if not.
    tolerance : float
        The largest error allowed.
    count : int
        How many numbers were compared.
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


def compare(
    quantity: str,
    reference: ArrayLike,
    ours: ArrayLike,
    tolerance: float,
    scale: float | None = None,
) -> Comparison:
    """Compare numbers or arrays.

    Parameters
    ----------
    quantity
        What is compared, with its unit.
    reference, ours
        Numbers, or arrays of the same shape.
    tolerance
        The largest deviation allowed, in units of `scale`.
    scale
        What deviations are measured by; the largest reference value unless given.

    Raises
    ------
    ValueError
        If shapes differ or there is no scale: a comparison that could not fail.
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
    """Compare words, such as "stable" with "unstable".

    Parameters
    ----------
    quantity
        What is judged.
    reference, ours
        Both verdicts.
    """
    return Comparison(quantity, reference, ours, 0.0 if reference == ours else math.inf, 0.0)


def at_least(quantity: str, expected: float, found: float, slack: float) -> Comparison:
    """Demand that a number, such as an order of convergence, does not fall short.

    Parameters
    ----------
    quantity
        What it is.
    expected, found
        What theory gives, and what was observed.
    slack
        By how much it may be missed.
    """
    short = expected - found
    error = short if math.isnan(short) else max(short, 0.0)
    return Comparison(f"{quantity}, at least", expected, float(found), error, slack)
