"""A batch function that counts, remembers and stops at a budget, for any search."""

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


class BudgetSpent(Exception):
    """Raised to a search when its budget is spent; its text is the reason."""


class Counted:
    """What a search evaluates through.

    Each distinct design is evaluated once (known by its exact bytes); NaN becomes +inf; the best
    design and every improvement are kept.

    Parameters
    ----------
    function : callable
        From n designs (n, k) to values (n,).
    budget : Budget or None
        When to stop.
    """

    def __init__(self, function: BatchFunction, budget: Budget | None = None) -> None:
        self._function = function
        self._budget = budget or Budget()
        self._began = time.monotonic()
        self._known: dict[bytes, float] = {}
        self._improvements: list[tuple[int, float, FloatArray]] = []
        self._first: FloatArray | None = None
        self.value = np.inf

    @property
    def evaluations(self) -> int:
        """Distinct designs evaluated."""
        return len(self._known)

    @property
    def design(self) -> FloatArray:
        """Best design, or the first one while all have failed, (k,)."""
        best = self._improvements[-1][2] if self._improvements else self._first
        if best is None:
            raise RuntimeError("nothing has been evaluated yet")
        return best

    def __call__(self, designs: FloatArray) -> FloatArray:
        """Values (n,) of designs (n, k).

        Raises
        ------
        BudgetSpent
            Before the batch if no budget is left; after as much of it as the budget allows.
        """
        designs = np.ascontiguousarray(designs, dtype=np.float64) + 0.0  # one kind of zero
        keys, fresh = self._sorted(designs)
        if fresh:
            for _ in self._evaluate(designs, fresh, len(fresh)):
                pass
        return np.array([self._known[key] for key in keys])

    def stream(self, designs: FloatArray, part: int) -> Generator[int, None, None]:
        """Evaluate designs (n, k) in order; yield now and then how many of them are done.

        Parameters
        ----------
        designs : (n, k) array
            Designs.
        part : int
            How many to evaluate between two yields, if the function does not choose that itself.

        Raises
        ------
        BudgetSpent
            As for values.
        """
        designs = np.ascontiguousarray(designs, dtype=np.float64) + 0.0
        _, fresh = self._sorted(designs)
        rows = [*fresh.values(), len(designs)]
        if fresh:
            for done in self._evaluate(designs, fresh, part):
                yield rows[done]

    def residuals(self, designs: FloatArray) -> FloatArray:
        """Vectors (n, r) of designs (n, k), each design counted as it is for its value.

        Raises
        ------
        InputError
            If the function has no vector.
        BudgetSpent
            As for values.
        """
        if not isinstance(self._function, VectorFunction):
            raise InputError("what is minimised is one number for each design, not a vector.")
        self(designs)
        return np.asarray(self._function.residuals(designs), dtype=np.float64)

    def jacobian(self, designs: FloatArray) -> FloatArray | None:
        """Exact Jacobians (n, r, k) at designs (n, k); None if the function has none."""
        if not isinstance(self._function, DifferentiableVectorFunction):
            return None
        found = self._function.jacobian(designs)
        return None if found is None else np.asarray(found, dtype=np.float64)

    def gradient(self, designs: FloatArray) -> FloatArray | None:
        """Exact gradients (n, k) at designs (n, k); None if the function has none."""
        if not isinstance(self._function, DifferentiableFunction):
            return None
        found = self._function.gradient(designs)
        return None if found is None else np.asarray(found, dtype=np.float64)

    def progress(self, iteration: int, detail: str, remaining: int | None = None) -> Progress:
        """Say where the search stands."""
        return Progress(iteration, self.evaluations, self.design, self.value, detail, remaining)

    def result(self, iterations: int, reason: str) -> SearchResult:
        """Return what the search found."""
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

    def _sorted(self, designs: FloatArray) -> tuple[list[bytes], dict[bytes, int]]:
        """Keys of designs, and those not known yet with the first row of each."""
        keys = [row.tobytes() for row in designs]
        fresh: dict[bytes, int] = {}
        for row, key in enumerate(keys):
            if key not in self._known:
                fresh.setdefault(key, row)
        return keys, fresh

    def _evaluate(
        self, designs: FloatArray, fresh: dict[bytes, int], part: int
    ) -> Generator[int, None, None]:
        """Evaluate what is not known yet, within the budget; yield how many of it are done."""
        limit = self._budget.evaluations
        left = len(fresh) if limit is None else min(limit - self.evaluations, len(fresh))
        if left <= 0:
            raise BudgetSpent(f"the budget of {limit} evaluations is spent")
        self._check_time()
        keys, rows = list(fresh), list(fresh.values())
        done = 0
        with closing(self._values(designs[rows[:left]], part)) as parts:
            for values in parts:
                last = done + len(values)
                for key, row, value in zip(
                    keys[done:last], rows[done:last], values.tolist(), strict=True
                ):
                    self._note(key, designs[row], value)
                done = last
                yield done
                if done < left:
                    self._check_time()
        if done != left:
            raise RuntimeError(f"{left} designs gave {done} values")
        if left < len(fresh):
            raise BudgetSpent(f"the budget of {limit} evaluations is spent")

    def _values(self, designs: FloatArray, part: int) -> Generator[FloatArray, None, None]:
        if isinstance(self._function, StreamingFunction) and part < len(designs):
            yield from self._function.stream(designs)
            return
        for first in range(0, len(designs), part):
            asked = designs[first : first + part]
            values = np.asarray(self._function(asked), dtype=np.float64)
            if values.shape != (len(asked),):
                raise RuntimeError(f"{len(asked)} designs gave values of shape {values.shape}")
            yield values

    def _note(self, key: bytes, design: FloatArray, value: float) -> None:
        self._known[key] = np.inf if np.isnan(value) else value
        if self._first is None:
            self._first = design.copy()
        if self._known[key] < self.value:
            self.value = value
            self._improvements.append((len(self._known), value, design.copy()))

    def _check_time(self) -> None:
        seconds = self._budget.seconds
        if seconds is not None and self.evaluations and time.monotonic() - self._began >= seconds:
            raise BudgetSpent(f"the budget of {seconds:g} s is spent")
