"""A batch function that evaluates each distinct design once."""

from __future__ import annotations

from collections.abc import Container, Generator, Mapping
from contextlib import closing

import numpy as np

from flexor.optimizers.interface import BatchFunction, FloatArray, StreamingFunction


class CachedEvaluator:
    """From designs (n, k) to values (n,), each distinct design evaluated once.

    Designs are known by their exact bytes, with one kind of zero; NaN becomes +inf.

    Parameters
    ----------
    function : callable
        From n designs (n, k) to values (n,).
    known : dict of float, optional
        Values from an earlier run, by the bytes of the design.
    """

    def __init__(self, function: BatchFunction, known: Mapping[bytes, float] | None = None) -> None:
        self._function = function
        self._values = dict(known or {})
        self._earlier = set(self._values)
        self.evaluated = 0  # designs, now
        self.replayed = 0  # designs answered from what was known before

    def __call__(self, designs: FloatArray) -> FloatArray:
        """Values of designs (n, k); +inf for those that failed."""
        return np.concatenate([np.zeros(0), *self.stream(designs)])

    def stream(
        self, designs: FloatArray, part: int | None = None
    ) -> Generator[FloatArray, None, None]:
        """Yield values of designs (n, k) in order, some of them at a time.

        That is ``part`` of them, all by default, if the function does not choose that itself.
        """
        designs = normalized(designs)
        keys = [row.tobytes() for row in designs]
        fresh = first_rows(designs, self._values)
        replayed = self._earlier.intersection(keys)
        self._earlier -= replayed
        self.replayed += len(replayed)
        new, rows = list(fresh), [*fresh.values(), len(designs)]
        given, done = 0, 0
        if fresh:
            with closing(self._evaluate(designs[rows[:-1]], part or len(new))) as parts:
                for values in parts:
                    values = np.where(np.isnan(values), np.inf, values)
                    self._values.update(zip(new[done:], values.tolist(), strict=False))
                    self.evaluated += len(values)
                    done += len(values)
                    if done > len(new):
                        break
                    # All up to the next that is not known yet.
                    yield np.array([self._values[key] for key in keys[given : rows[done]]])
                    given = rows[done]
            if done != len(new):
                raise RuntimeError(f"{len(new)} designs gave {done} values")
        if given < len(keys):
            yield np.array([self._values[key] for key in keys[given:]])

    def _evaluate(self, designs: FloatArray, part: int) -> Generator[FloatArray, None, None]:
        """Yield values of designs that are not known yet, in order."""
        if isinstance(self._function, StreamingFunction) and part < len(designs):
            yield from self._function.stream(designs)
            return
        for first in range(0, len(designs), part):
            asked = designs[first : first + part]
            values = np.asarray(self._function(asked), dtype=np.float64)
            if values.shape != (len(asked),):
                raise RuntimeError(f"{len(asked)} designs gave values of shape {values.shape}")
            yield values


def first_rows(designs: FloatArray, known: Container[bytes]) -> dict[bytes, int]:
    """Return the distinct designs that are not known yet, with the first row of each."""
    fresh: dict[bytes, int] = {}
    for row, key in enumerate(design.tobytes() for design in designs):
        if key not in known:
            fresh.setdefault(key, row)
    return fresh


def normalized(designs: FloatArray) -> FloatArray:
    """Return designs (n, k) in the form in which equal ones have equal bytes."""
    return np.ascontiguousarray(designs, dtype="<f8") + 0.0  # one kind of zero
