"""Starting designs: the given ones, completed by random ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from flexor.errors import InputError
from flexor.optimizers.interface import FloatArray


def starting_designs(
    start: ArrayLike | None,
    count: int,
    lower: FloatArray,
    upper: FloatArray,
    random: np.random.Generator,
) -> FloatArray:
    """Complete the given starts to ``count`` with a Latin hypercube sample.

    All given ones, (k,) or (s, k), are kept and come first in the result, (max(s, count), k).
    InputError if one is outside the bounds ``lower`` and ``upper`` (k,).
    """
    k = lower.size
    given: FloatArray = np.empty((0, k))
    if start is not None:
        given = np.atleast_2d(np.asarray(start, dtype=np.float64))
        if given.ndim != 2 or given.shape[1] != k:
            raise InputError(f"a start has {k} numbers, got an array of shape {np.shape(start)}.")
        for design in given:
            if not np.all((design >= lower) & (design <= upper)):
                raise InputError(
                    f"the start {design.tolist()} is outside the bounds "
                    f"{lower.tolist()} to {upper.tolist()}."
                )
    more = max(count - len(given), 0)
    cells = np.stack([random.permutation(more) for _ in range(k)], axis=1).reshape(more, k)
    unit = (cells + random.uniform(size=(more, k))) / max(more, 1)
    return np.concatenate((given, np.clip(lower + unit * (upper - lower), lower, upper)))
