"""How well the targets identify the constants: local identifiability and profile likelihood.

The terms are those of Raue et al., Structural and practical identifiability analysis of partially
observed dynamical models by exploiting the profile likelihood, Bioinformatics 25, 2009. With
Gaussian errors, the misfit is minus twice the log-likelihood up to a constant.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from flexor.arrays import Array
from flexor.calibration.constants import Constant
from flexor.calibration.evaluator import Evaluator
from flexor.calibration.local_fit import Minimum, fit_locally

Verdict = Literal[
    "identifiable", "only in combination", "not identifiable", "at the end of its range"
]
_PRIOR_VARIANCE = 1.0 / 12.0  # of a uniform distribution over the range
_IDENTIFIABLE = 0.05  # standard deviation as a part of the range
_DISTANCES = (1.0, 2.0, 3.5)  # of the points of a profile, in standard deviations
THRESHOLD = 3.841  # 95 % quantile of chi-squared with one degree of freedom


@dataclass(frozen=True, eq=False)
class Profile:
    """Profile likelihood of one constant: the misfit with all other constants fitted again."""

    u: Array  # (p,), the constant as a fraction of its range, increasing
    rise: Array  # (p,), misfit above that of the fit
    lowest: Minimum  # best of the fits along the profile

    def interval(self) -> tuple[float, float]:
        """Return the 95 % confidence interval as fractions of the range, (low, high)."""
        best = int(np.argmin(self.rise))
        low = self._crossing(range(best, -1, -1), 0.0)
        return low, self._crossing(range(best, len(self.u)), 1.0)

    def _crossing(self, rows: range, open_end: float) -> float:
        threshold = math.sqrt(THRESHOLD)
        for before, after in pairwise(rows):
            # Near the minimum the misfit is quadratic, so its root is interpolated linearly.
            first, last = (math.sqrt(max(self.rise[row], 0.0)) for row in (before, after))
            if last >= threshold > first:
                share = (threshold - first) / (last - first)
                return float(self.u[before] + share * (self.u[after] - self.u[before]))
        at_bound = len(rows) > 0 and self.u[rows[-1]] in (0.0, 1.0)
        return float(self.u[rows[-1]]) if at_bound else open_end


@dataclass(frozen=True, eq=False)
class Direction:
    """A combination of constants, in parts of their ranges."""

    weights: Array  # (c,), a unit vector
    deviation: float  # standard deviation along it


@dataclass(frozen=True, eq=False)
class Identifiability:
    """How well the constants of a fit are identified."""

    constants: tuple[Constant, ...]  # c of them
    u: Array  # (c,), the fit, in parts of their ranges
    jacobian: Array  # (r, c), of the residuals, by parts of the ranges
    deviation: Array  # (c,), standard deviations in parts of the ranges, all others free
    conditional_deviation: Array  # (c,), with all others fixed
    # Eigenvectors of the information matrix, the best identified first.
    directions: tuple[Direction, ...]
    profiles: tuple[Profile, ...] = ()  # one for each constant, or none

    def verdict(self, i: int) -> Verdict:
        """Return how well a constant is identified, in words."""
        if self.u[i] in (0.0, 1.0):
            return "at the end of its range"
        if self.deviation[i] <= _IDENTIFIABLE:
            return "identifiable"
        alone = self.conditional_deviation[i] <= _IDENTIFIABLE
        return "only in combination" if alone else "not identifiable"

    def interval(self, i: int) -> tuple[float, float]:
        """Return the 95 % confidence interval of a constant, SI; from the profile if there is one.

        Without a profile it follows from the standard deviation.
        """
        if self.profiles:
            low, high = self.profiles[i].interval()
        else:
            reach = 1.96 * self.deviation[i]
            low, high = max(self.u[i] - reach, 0.0), min(self.u[i] + reach, 1.0)
        values = self.constants[i].value(np.array([low, high]))
        return float(values[0]), float(values[1])

    def describe(self, direction: Direction) -> str:
        """Return a direction as a combination of constants, with its 95 % range."""
        order = [int(i) for i in np.argsort(-np.abs(direction.weights))]
        matter = [i for i in order if abs(direction.weights[i]) >= 0.1]
        if not all(self.constants[i].log for i in matter):
            shares = (f"{direction.weights[i]:+.2f} {self.constants[i].name}" for i in matter)
            spread = f"to ±{196.0 * direction.deviation:.2g} % of their ranges"
            return f"{' '.join(shares)} {spread}".replace("-", "−")
        # On logarithmic scales a sum of parts of the ranges is a product of powers.
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
        spread = percent if factor < 1.5 else f"within a factor of {factor:.2g}"
        return f"{' · '.join(powers)} {spread}"


def local_identifiability(evaluator: Evaluator, minimum: Minimum) -> Identifiability:
    """Analyse a fit by the Jacobian of its residuals.

    The information matrix is JᵀJ with the variance of a uniform distribution over each range as
    prior knowledge.
    """
    every = range(len(minimum.u))
    jacobian = evaluator.jacobian(minimum.u, every, evaluator.problem.fitted_runs)
    jacobian = np.nan_to_num(jacobian)
    information = jacobian.T @ jacobian + np.eye(len(minimum.u)) / _PRIOR_VARIANCE
    values, vectors = np.linalg.eigh(information)
    return Identifiability(
        constants=evaluator.problem.constants,
        u=minimum.u,
        jacobian=jacobian,
        deviation=np.sqrt(np.diag(np.linalg.inv(information))),
        conditional_deviation=1.0 / np.sqrt(np.diag(information)),
        directions=tuple(
            Direction(_oriented(vectors[:, i]), float(1.0 / math.sqrt(values[i])))
            for i in np.argsort(-values)
        ),
    )


def profile_likelihood(evaluator: Evaluator, minimum: Minimum, i: int, deviation: float) -> Profile:
    """Move constant `i` away from a minimum in multiples of `deviation`, fitting all others."""
    found = {float(minimum.u[i]): minimum}
    for side in (-1.0, 1.0):
        at = minimum
        for distance in _DISTANCES:
            u = at.u.copy()
            u[i] = np.clip(minimum.u[i] + side * distance * deviation, 0.0, 1.0)
            if float(u[i]) in found:
                break
            at = fit_locally(evaluator, u, fixed=(i,))
            found[float(u[i])] = at
    places = sorted(found)
    rise = np.array([found[place].misfit for place in places]) - minimum.misfit
    lowest = min(found.values(), key=lambda m: m.misfit)
    return Profile(np.array(places), np.maximum(rise, 0.0), lowest)


def _oriented(vector: Array) -> Array:
    return np.asarray(vector * np.sign(vector[np.argmax(np.abs(vector))]))


def _power(exponent: float) -> str:
    if abs(exponent - 1.0) < 0.005:
        return ""
    return f"^{exponent:.2g}".replace("-", "−")
