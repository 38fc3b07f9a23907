"""The function of a run in the unit box, with all that is known of it, for methods in stages."""

from __future__ import annotations

import numpy as np

from flexor.optimizers.interface import FloatArray
from flexor.optimizers.method import Run


class Known:
    """The function of a run, with a record of all values so far.

    Parameters
    ----------
    run : Run
        The run that all stages belong to.
    """

    def __init__(self, run: Run) -> None:
        self._run = run
        self._values: dict[bytes, float] = {}

    def __len__(self) -> int:
        return len(self._values)

    def __call__(self, points: FloatArray) -> FloatArray:
        """Return the values (n,) of points (n, k) in the unit box."""
        found = self._run.values(points)
        for point, value in zip(points, found.tolist(), strict=True):
            self._values[point.tobytes()] = value
        return found

    def gradient(self, points: FloatArray) -> FloatArray | None:
        """Return exact gradients (n, k) at points (n, k), or None if the objective has none."""
        return self._run.gradient(points)

    def best(self, count: int, distance: float) -> FloatArray:
        """Return the best points (m, k), m ≤ ``count``, whose distances exceed ``distance``.

        Of those that did not fail.
        """
        keys, values = list(self._values), np.array(list(self._values.values()))
        found = np.empty((min(count, len(keys)), self._run.size))
        n = 0
        for i in np.argsort(values, kind="stable").tolist():
            if n == len(found) or not np.isfinite(values[i]):
                break
            point = np.frombuffer(keys[i])
            if (np.abs(found[:n] - point).max(axis=1) > distance).all():
                found[n] = point
                n += 1
        return found[:n]
