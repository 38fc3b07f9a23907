"""Points of a box at which functions of its variables are fitted and checked."""

from __future__ import annotations

import numpy as np

from flexor.arrays import Array


def sobol_points(count: int, k: int, seed: int) -> Array:
    """Return the first points of a Sobol sequence in [-1, 1]^k, (count, k)."""
    from scipy.stats import qmc  # deferred: slow to import

    size = 1 << (count - 1).bit_length()
    return np.asarray(2.0 * qmc.Sobol(k, scramble=True, seed=seed).random(size)[:count] - 1.0)


def points_of_box(count: int, k: int) -> Array:
    """Return points inside the box at which a map is checked, (c, k) in [-1, 1]."""
    return 0.999 * sobol_points(count, k, seed=2)


def vertices(k: int) -> Array:
    """Return vertices of [-1, 1]^k, (c, k): a two-level orthogonal array of strength 3.

    It is the foldover of a Hadamard matrix, see Hedayat, Sloane and Stufken (1999), section 7.5.
    """
    from scipy.linalg import hadamard  # deferred: slow to import

    signs = hadamard(1 << (k - 1).bit_length())[:, :k]
    return np.unique(np.concatenate([signs, -signs]), axis=0).astype(float)
