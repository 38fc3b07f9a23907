"""Incomplete elliptic integrals from Carlson's symmetric forms.

`scipy.special.ellipkinc` and `ellipeinc` are wrong by tenths at isolated arguments (in SciPy 1.17,
`ellipeinc(1.1337796627061758, 0.7499999999999999)` is 1.125 instead of 0.974); these are not.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import elliprd, elliprf

Array = NDArray[np.float64]


def first(phi: ArrayLike, m: float) -> Array:
    """Return F(φ | m) for parameters m < 1."""
    turns, sine, squared = _reduced(phi)
    complete = elliprf(0.0, 1.0 - m, 1.0)
    return np.asarray(2.0 * turns * complete + sine * elliprf(squared, 1.0 - m * sine**2, 1.0))


def second(phi: ArrayLike, m: float) -> Array:
    """Return E(φ | m) for parameters m < 1."""
    turns, sine, squared = _reduced(phi)
    complete = elliprf(0.0, 1.0 - m, 1.0) - m / 3.0 * elliprd(0.0, 1.0 - m, 1.0)
    other = 1.0 - m * sine**2
    part = elliprf(squared, other, 1.0) - m / 3.0 * sine**2 * elliprd(squared, other, 1.0)
    return np.asarray(2.0 * turns * complete + sine * part)


def _reduced(phi: ArrayLike) -> tuple[Array, Array, Array]:
    """Half turns taken off, and sine and squared cosine of what remains."""
    angle = np.asarray(phi, dtype=float)
    turns = np.round(angle / np.pi)
    rest = angle - np.pi * turns
    return turns, np.sin(rest), np.cos(rest) ** 2
