"""Polynomials through samples of functions, and quotients of two, checked at other points."""

from __future__ import annotations

from collections.abc import Callable
from math import comb

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.design.box_points import sobol_points
from flexor.design.polynomials import Powers, basis, powers_up_to
from flexor.design.slot_map import FORMS

# Of a parameter, as a share of its largest value in the box.
TOLERANCE = 1e-11
MAX_DEGREE = 12
# The least that the denominator of a quotient may be, as a share of its largest value, and at how
# many points all over the box, vertices besides, that is checked.
_LEAST, _DENSE = 1e-3, 512
_LOW = 4  # up to this degree also forms of a polynomial are tried
_FIRST, _MOST = 24, 1200  # points of the first attempts at most, and of the last


def enough(variables: int) -> int:
    """Return how many points polynomials of degree 3 take, or of one variable of any degree."""
    return max((3 * comb(variables + 3, 3) + 1) // 2, 2 * MAX_DEGREE + 2)


def rounds(variables: int) -> list[int]:
    """Return numbers of points, each about twice the one before.

    Up to `enough` for polynomials, and beyond for what is close to one, such as the shear of a
    section by its walls, or the end of a rod that is curved in the reference state.
    """
    counts = [enough(variables)]
    while counts[0] > _FIRST:
        counts.insert(0, (counts[0] + 1) // 2)
    most = min((3 * comb(variables + MAX_DEGREE, MAX_DEGREE) + 1) // 2, _MOST)
    while counts[-1] < most:
        counts.append(min(2 * counts[-1], most))
    return counts


class Fitting:
    """Least squares with polynomials in some of the variables, of one degree after another.

    Parameters
    ----------
    u : (s, k) array
        Points in [-1, 1].
    pattern
        The variables.
    count
        How many of the points are fitted, with the degrees that these allow; the others check.
    """

    def __init__(self, u: Array, pattern: tuple[int, ...], count: int) -> None:
        self._u, self._pattern, self._count = u, pattern, count
        k = len(pattern)
        degrees = [d for d in range(1, MAX_DEGREE + 1) if 1.5 * comb(k + d, d) <= count]
        self.degrees = degrees
        self._powers = powers_up_to(pattern, max(degrees, default=0), u.shape[1])
        self._basis = basis(u, self._powers)
        # Terms of lower degree are first, so that one factorization is that of all degrees.
        self._q, self._r = np.linalg.qr(self._basis[:count])

    def attempts(self) -> list[tuple[str, int]]:
        """Return forms and degrees in the order in which they are to be tried."""
        low = [(form, degree) for degree in self.degrees[:_LOW] for form in FORMS]
        return low + [("polynomial", degree) for degree in self.degrees[_LOW:]]

    def fit(
        self, samples: Array, form: str, degree: int
    ) -> tuple[Powers, Array, NDArray[np.bool_]]:
        """Fit columns (s, m); return terms, coefficients (c, m), and which hold at all points."""
        terms = comb(len(self._pattern) + degree, degree)

        def solve(wanted: Array) -> Array:
            right = self._q[:, :terms].T @ wanted
            return np.asarray(np.linalg.solve(self._r[:terms, :terms], right))

        found, good = _checked(self._basis[:, :terms], samples, form, self._count, solve)
        return self._powers[:terms], found, good


def fitted(
    u: Array, samples: Array, powers: Powers, form: str, count: int
) -> tuple[Array, NDArray[np.bool_]]:
    """Fit columns at the first points; return their coefficients, and which hold at all points."""
    terms = basis(u, powers)

    def solve(wanted: Array) -> Array:
        return np.asarray(np.linalg.lstsq(terms[:count], wanted, rcond=None)[0])

    return _checked(terms, samples, form, count, solve)


def _checked(
    terms: Array, samples: Array, form: str, count: int, solve: Callable[[Array], Array]
) -> tuple[Array, NDArray[np.bool_]]:
    inverse, forward, _ = FORMS[form]
    with np.errstate(divide="ignore", invalid="ignore"):
        wanted = inverse(samples)
        usable = np.isfinite(wanted).all(axis=0)
        if form != "polynomial":
            usable &= (samples > 0.0).all(axis=0)
        wanted = np.where(usable, wanted, 0.0)
        scale = np.abs(wanted).max(axis=0)
        scale[scale == 0.0] = 1.0
        coefficients = solve(wanted[:count] / scale)
        coefficients[np.abs(coefficients) < 1e-14] = 0.0
        found = forward(terms @ coefficients * scale)
    largest = np.abs(samples).max(axis=0)
    good = usable & (np.abs(found - samples).max(axis=0) <= TOLERANCE * largest)
    return coefficients * scale, np.asarray(good)


def quotient_degrees(variables: int, points: int, few: int, columns: int) -> list[int]:
    """Return the degrees of quotients that are tried for what no few points make a polynomial."""
    degrees = range(1, MAX_DEGREE + 1) if points >= few and columns else ()
    return [d for d in degrees if 1.5 * (2 * comb(variables + d, d) - 1) <= points]


def quotient(u: Array, samples: Array, powers: Powers, count: int) -> tuple[Array, Array] | None:
    """Fit a quotient to samples (s,) at the first points; return both polynomials' coefficients.

    That is the least denominator besides its constant; None if it does not hold at all points.
    """
    scale = np.abs(samples).max()
    if scale == 0.0:
        return None
    terms = basis(u, powers)
    constant = ~powers.any(axis=1)
    wanted = samples / scale
    matrix = np.concatenate([terms, -wanted[:, None] * terms[:, ~constant]], axis=1)
    found = np.linalg.lstsq(matrix[:count], wanted[:count], rcond=None)[0]
    above, below = found[: len(powers)], np.ones(len(powers))
    below[~constant] = found[len(powers) :]
    bottom, dense = terms @ below, basis(sobol_points(_DENSE, u.shape[1], seed=3), powers) @ below
    if min(bottom.min(), dense.min()) < _LEAST * max(bottom.max(), dense.max()):
        return None
    if not (np.abs(terms @ above / bottom - wanted) <= TOLERANCE).all():
        return None
    return above * scale, below


def trimmed(powers: Powers, coefficients: Array) -> tuple[Powers, Array]:
    """Return the terms that have a coefficient."""
    used = coefficients.any(axis=1)
    return powers[used], coefficients[used]
