"""Cached, counted evaluation of a batch function within a budget."""

from __future__ import annotations

import time
from collections.abc import Generator
from contextlib import closing

import numpy as np

from flexor.errors import InputError
from flexor.optimizers.interface import (
    BatchFunction,
    Budget,
    DifferentiableFunction,
    DifferentiableVectorFunction,
    FloatArray,
    Progress,
    SearchResult,
    StreamingFunction,
    VectorFunction,
)


class BudgetExhausted(Exception):
    """Raised when the budget is exhausted; its message is the reason for stopping."""


class CachedEvaluator:
    """Evaluates designs for a search and caches their values.

    Each distinct design (compared bitwise) is evaluated once. NaN becomes +inf. The best design
    and the history of improvements are kept.

    Parameters
    ----------
    function : callable
        Maps n designs (n, k) to values (n,).
    budget : Budget or None
        Limits of the search.
    """

    def __init__(self, function: BatchFunction, budget: Budget | None = None) -> None:
        self._function = function
        self._budget = budget or Budget()
        self._start_time = time.monotonic()
        self._cache: dict[bytes, float] = {}
        self._improvements: list[tuple[int, float, FloatArray]] = []
        self._first: FloatArray | None = None
        self.value = np.inf

    @property
    def evaluations(self) -> int:
        """Number of distinct designs evaluated."""
        return len(self._cache)

    @property
    def design(self) -> FloatArray:
        """Best design, or the first one if all have failed, (k,)."""
        best = self._improvements[-1][2] if self._improvements else self._first
        if best is None:
            raise RuntimeError("no design has been evaluated yet")
        return best

    def __call__(self, designs: FloatArray) -> FloatArray:
        """Evaluate designs (n, k); return their values (n,).

        Raises
        ------
        BudgetExhausted
            If the budget does not cover the batch; the part that it covers is evaluated first.
        """
        designs = np.ascontiguousarray(designs, dtype=np.float64) + 0.0  # normalises -0.0
        keys, pending = self._lookup(designs)
        if pending:
            for _ in self._evaluate(designs, pending, len(pending)):
                pass
        return np.array([self._cache[key] for key in keys])

    def stream(self, designs: FloatArray, part: int) -> Generator[int, None, None]:
        """Evaluate designs (n, k) in chunks; yield the number completed after each chunk.

        Parameters
        ----------
        designs : (n, k) array
            Designs.
        part : int
            Chunk size, unless the function streams its values itself.

        Raises
        ------
        BudgetExhausted
            As for `__call__`.
        """
        designs = np.ascontiguousarray(designs, dtype=np.float64) + 0.0
        _, pending = self._lookup(designs)
        rows = [*pending.values(), len(designs)]
        if pending:
            for done in self._evaluate(designs, pending, part):
                yield rows[done]

    def residuals(self, designs: FloatArray) -> FloatArray:
        """Return the residual vectors (n, r) of designs (n, k), counted as evaluations.

        Raises
        ------
        InputError
            If the function is not the norm of a residual vector.
        BudgetExhausted
            As for `__call__`.
        """
        if not isinstance(self._function, VectorFunction):
            raise InputError(
                "the objective is a scalar: least squares needs one that is the norm of a vector."
            )
        self(designs)
        return np.asarray(self._function.residuals(designs), dtype=np.float64)

    def jacobian(self, designs: FloatArray) -> FloatArray | None:
        """Return the exact Jacobians (n, r, k) at designs (n, k), or None if not available."""
        if not isinstance(self._function, DifferentiableVectorFunction):
            return None
        result = self._function.jacobian(designs)
        return None if result is None else np.asarray(result, dtype=np.float64)

    def gradient(self, designs: FloatArray) -> FloatArray | None:
        """Return the exact gradients (n, k) at designs (n, k), or None if not available."""
        if not isinstance(self._function, DifferentiableFunction):
            return None
        result = self._function.gradient(designs)
        return None if result is None else np.asarray(result, dtype=np.float64)

    def progress(self, iteration: int, detail: str, remaining: int | None = None) -> Progress:
        """Return the current state of the search."""
        return Progress(iteration, self.evaluations, self.design, self.value, detail, remaining)

    def result(self, iterations: int, reason: str) -> SearchResult:
        """Return the result of the search."""
        k = self.design.size
        return SearchResult(
            design=self.design,
            value=self.value,
            evaluations=self.evaluations,
            iterations=iterations,
            reason=reason,
            improvement_evaluations=np.array([i[0] for i in self._improvements], dtype=np.int64),
            improvement_values=np.array([i[1] for i in self._improvements], dtype=np.float64),
            improvement_designs=np.array([i[2] for i in self._improvements]).reshape(-1, k),
        )

    def _lookup(self, designs: FloatArray) -> tuple[list[bytes], dict[bytes, int]]:
        """Return the cache keys of designs, and the first row of each key not yet cached."""
        keys = [row.tobytes() for row in designs]
        pending: dict[bytes, int] = {}
        for row, key in enumerate(keys):
            if key not in self._cache:
                pending.setdefault(key, row)
        return keys, pending

    def _evaluate(
        self, designs: FloatArray, pending: dict[bytes, int], part: int
    ) -> Generator[int, None, None]:
        """Evaluate pending designs within the budget; yield the number completed."""
        limit = self._budget.evaluations
        left = len(pending) if limit is None else min(limit - self.evaluations, len(pending))
        if left <= 0:
            raise BudgetExhausted(f"the budget of {limit} evaluations is spent")
        self._check_time()
        keys, rows = list(pending), list(pending.values())
        done = 0
        with closing(self._values(designs[rows[:left]], part)) as parts:
            for values in parts:
                last = done + len(values)
                for key, row, value in zip(
                    keys[done:last], rows[done:last], values.tolist(), strict=True
                ):
                    self._store(key, designs[row], value)
                done = last
                yield done
                if done < left:
                    self._check_time()
        if done != left:
            raise RuntimeError(f"{left} designs gave {done} values")
        if left < len(pending):
            raise BudgetExhausted(f"the budget of {limit} evaluations is spent")

    def _values(self, designs: FloatArray, part: int) -> Generator[FloatArray, None, None]:
        if isinstance(self._function, StreamingFunction) and part < len(designs):
            yield from self._function.stream(designs)
            return
        for first in range(0, len(designs), part):
            chunk = designs[first : first + part]
            values = np.asarray(self._function(chunk), dtype=np.float64)
            if values.shape != (len(chunk),):
                raise RuntimeError(f"{len(chunk)} designs gave values of shape {values.shape}")
            yield values

    def _store(self, key: bytes, design: FloatArray, value: float) -> None:
        self._cache[key] = np.inf if np.isnan(value) else value
        if self._first is None:
            self._first = design.copy()
        if self._cache[key] < self.value:
            self.value = value
            self._improvements.append((len(self._cache), value, design.copy()))

    def _check_time(self) -> None:
        seconds = self._budget.seconds
        if seconds is None or not self.evaluations:
            return
        if time.monotonic() - self._start_time >= seconds:
            raise BudgetExhausted(f"the budget of {seconds:g} s is spent")
