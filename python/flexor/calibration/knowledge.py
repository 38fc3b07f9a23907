"""What the targets say about the constants: which they pin down, and which only together."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from flexor.calibration.constants import Constant
from flexor.calibration.evaluate import Evaluator
from flexor.calibration.refine import Minimum, refine

Array = NDArray[np.float64]
Verdict = Literal["pinned down", "only in combination", "not determined"]
# The range itself is knowledge: an even distribution over it has this variance.
_RANGE = 1.0 / 12.0
_PINNED = 0.05  # standard deviation as a part of the range
_SIDES = (1.0, 2.0, 3.5)  # where profiles are taken, in standard deviations
_LIKELY = 3.841  # 95 % of chi-squared with one degree of freedom


@dataclass(frozen=True, eq=False)
class Profile:
    """How the misfit rises as one constant is moved and all others are fitted anew.

    Attributes
    ----------
    u : (p,) array
        The constant, as a fraction of its range, increasing.
    rise : (p,) array
        Misfit above that of the fit.
    lowest : Minimum
        The best of the fits made on the way.
    """

    u: Array
    rise: Array
    lowest: Minimum

    def ends(self) -> tuple[float, float]:
        """Fractions between which the constant lies with 95 % likelihood, (low, high)."""
        best = int(np.argmin(self.rise))
        low = self._crossing(range(best, -1, -1), 0.0)
        return low, self._crossing(range(best, len(self.u)), 1.0)

    def _crossing(self, rows: range, open_end: float) -> float:
        wanted = math.sqrt(_LIKELY)
        for before, after in pairwise(rows):
            # Near the best the misfit rises as a square, so its root rises as a line.
            first, last = (math.sqrt(max(self.rise[row], 0.0)) for row in (before, after))
            if last >= wanted > first:
                share = (wanted - first) / (last - first)
                return float(self.u[before] + share * (self.u[after] - self.u[before]))
        at_bound = len(rows) > 0 and self.u[rows[-1]] in (0.0, 1.0)
        return float(self.u[rows[-1]]) if at_bound else open_end


@dataclass(frozen=True, eq=False)
class Direction:
    """A combination of constants, and how well it is known.

    Attributes
    ----------
    weights : (f,) array
        Of the constants, in parts of their ranges; a unit vector.
    deviation : float
        Standard deviation along it, in parts of the ranges.
    """

    weights: Array
    deviation: float


@dataclass(frozen=True, eq=False)
class Knowledge:
    """What the targets say about the free constants of a fit.

    Attributes
    ----------
    constants : tuple of Constant
        The f free constants.
    u : (f,) array
        Where the fit is, in parts of their ranges.
    jacobian : (r, f) array
        Of the residuals, by parts of the ranges.
    deviation : (f,) array
        Standard deviation of each constant, in parts of its range, the others being unknown.
    alone : (f,) array
        The same if the others were known.
    directions : tuple of Direction
        The best known first.
    profiles : tuple of Profile
        One for each constant, or none.
    """

    constants: tuple[Constant, ...]
    u: Array
    jacobian: Array
    deviation: Array
    alone: Array
    directions: tuple[Direction, ...]
    profiles: tuple[Profile, ...]

    def verdict(self, i: int) -> Verdict:
        """Say in words how well a constant is known."""
        if self.deviation[i] <= _PINNED:
            return "pinned down"
        return "only in combination" if self.alone[i] <= _PINNED else "not determined"

    def interval(self, i: int) -> tuple[float, float]:
        """Values between which a constant lies with 95 % likelihood, SI."""
        if self.profiles:
            low, high = self.profiles[i].ends()
        else:
            reach = 1.96 * self.deviation[i]
            low, high = max(self.u[i] - reach, 0.0), min(self.u[i] + reach, 1.0)
        values = self.constants[i].value(np.array([low, high]))
        return float(values[0]), float(values[1])

    def told(self, direction: Direction) -> str:
        """Write a direction as the combination of constants that is known, and how well."""
        order = [int(i) for i in np.argsort(-np.abs(direction.weights))]
        matter = [i for i in order if abs(direction.weights[i]) >= 0.1]
        if not all(self.constants[i].log for i in matter):
            shares = (f"{direction.weights[i]:+.2f} {self.constants[i].name}" for i in matter)
            spread = f"to ±{196.0 * direction.deviation:.2g} % of their ranges"
            return f"{' '.join(shares)} {spread}".replace("-", "−")
        # Where the scale is logarithmic, a sum of parts of the ranges is a product of powers.
        exponents = [
            direction.weights[i] / math.log(self.constants[i].high / self.constants[i].low)
            for i in matter
        ]
        powers = (
            f"{self.constants[i].name}{_power(exponent / exponents[0])}"
            for i, exponent in zip(matter, exponents, strict=True)
        )
        factor = math.exp(1.96 * direction.deviation / abs(exponents[0]))
        percent = f"to ±{100.0 * (factor - 1.0):.2g} %"
        known = percent if factor < 1.5 else f"within a factor of {factor:.2g}"
        return f"{' · '.join(powers)} {known}"


def know(evaluator: Evaluator, minimum: Minimum) -> Knowledge:
    """Work out what the targets say at a minimum; profiles are made by `profile`.

    Parameters
    ----------
    evaluator : Evaluator
        Of the variant.
    minimum : Minimum
        The fit.
    """
    every = range(len(minimum.u))
    slopes = np.nan_to_num(evaluator.slopes(minimum.u, every, evaluator.variant.fitted_runs))
    information = slopes.T @ slopes + np.eye(len(minimum.u)) / _RANGE
    strengths, vectors = np.linalg.eigh(information)
    order = np.argsort(-strengths)
    directions = tuple(
        Direction(_leading_positive(vectors[:, i]), float(1.0 / math.sqrt(strengths[i])))
        for i in order
    )
    return Knowledge(
        constants=evaluator.variant.free,
        u=minimum.u,
        jacobian=slopes,
        deviation=np.sqrt(np.diag(np.linalg.inv(information))),
        alone=1.0 / np.sqrt(np.diag(information)),
        directions=directions,
        profiles=(),
    )


def profile(evaluator: Evaluator, minimum: Minimum, i: int, deviation: float) -> Profile:
    """Move one constant away from a minimum, fitting the others anew.

    Parameters
    ----------
    evaluator : Evaluator
        Of the variant.
    minimum : Minimum
        The fit.
    i : int
        Which free constant.
    deviation : float
        Its standard deviation, in parts of its range, which sets how far it is moved.
    """
    found = {float(minimum.u[i]): minimum}
    for side in (-1.0, 1.0):
        at = minimum
        for distance in _SIDES:
            u = at.u.copy()
            u[i] = np.clip(minimum.u[i] + side * distance * deviation, 0.0, 1.0)
            if float(u[i]) in found:
                break
            at = refine(evaluator, u, held=(i,))
            found[float(u[i])] = at
    places = sorted(found)
    rise = np.array([found[place].misfit for place in places]) - minimum.misfit
    lowest = min(found.values(), key=lambda m: m.misfit)
    return Profile(np.array(places), np.maximum(rise, 0.0), lowest)


def _leading_positive(vector: Array) -> Array:
    return np.asarray(vector * np.sign(vector[np.argmax(np.abs(vector))]))


def _power(exponent: float) -> str:
    if abs(exponent - 1.0) < 0.005:
        return ""
    return f"^{exponent:.2g}".replace("-", "−")
