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
        chosen: list[FloatArray] = []
        for key in sorted(self._values, key=lambda key: self._values[key]):
            if not np.isfinite(self._values[key]):
                break
            point = np.frombuffer(key)
            if all(np.max(np.abs(point - other)) > distance for other in chosen):
                chosen.append(point)
                if len(chosen) == count:
                    break
        return np.array(chosen).reshape(len(chosen), self._run.size)
