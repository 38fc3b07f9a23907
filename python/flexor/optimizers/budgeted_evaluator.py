"""Evaluation within a budget, for any search."""

from __future__ import annotations

import time
from collections.abc import Generator
from contextlib import closing

import numpy as np

from flexor.errors import InputError
from flexor.optimizers.cached_evaluator import CachedEvaluator, first_rows, normalized
from flexor.optimizers.interface import (
    BatchFunction,
    Budget,
    ConstrainedFunction,
    DifferentiableFunction,
    DifferentiableVectorFunction,
    FloatArray,
    Linearized,
    LinearizedFunction,
    Progress,
    SearchResult,
    SeveralFunction,
    VectorFunction,
)


class BudgetExhausted(Exception):
    """Raised to a search when its budget is spent; its text is the reason."""


class BudgetedEvaluator:
    """What a search evaluates through: a `CachedEvaluator` that stops at a budget.

    It counts distinct designs and keeps the best and every improvement.

    Parameters
    ----------
    function : callable
        From n designs (n, k) to values (n,).
    budget : Budget or None
        When to stop.
    """

    def __init__(self, function: BatchFunction, budget: Budget | None = None) -> None:
        self._function = function
        self._cache = (
            function if isinstance(function, CachedEvaluator) else CachedEvaluator(function)
        )
        self._budget = budget or Budget()
        self._began = time.monotonic()
        self._asked: set[bytes] = set()
        self._improvements: list[tuple[int, float, FloatArray]] = []
        self._first: FloatArray | None = None
        self.value = np.inf

    @property
    def evaluations(self) -> int:
        """Distinct designs evaluated."""
        return len(self._asked)

    @property
    def remaining(self) -> int | None:
        """How many evaluations are left of the budget; None without one."""
        limit = self._budget.evaluations
        return None if limit is None else max(limit - self.evaluations, 0)

    @property
    def design(self) -> FloatArray:
        """Best design, or the first one while all have failed, (k,)."""
        best = self._improvements[-1][2] if self._improvements else self._first
        if best is None:
            raise RuntimeError("nothing has been evaluated yet")
        return best

    def __call__(self, designs: FloatArray) -> FloatArray:
        """Values (n,) of designs (n, k).

        BudgetExhausted before the batch if no budget is left, or after as much as it allows.
        """
        designs = normalized(designs)
        fresh = first_rows(designs, self._asked)
        if fresh:
            for _ in self._evaluate(designs, fresh, len(fresh)):
                pass
        return self._cache(designs)

    def stream(self, designs: FloatArray, part: int) -> Generator[int, None, None]:
        """Evaluate designs (n, k) in order; yield now and then how many of them are done.

        Between two yields are ``part`` of them, if the function does not choose that itself.
        BudgetExhausted as for values.
        """
        designs = normalized(designs)
        fresh = first_rows(designs, self._asked)
        rows = [*fresh.values(), len(designs)]
        if fresh:
            for done in self._evaluate(designs, fresh, part):
                yield rows[done]

    def residuals(self, designs: FloatArray) -> FloatArray:
        """Vectors (n, r) of designs (n, k), each design counted as it is for its value.

        InputError if the function has no vector; BudgetExhausted as for values.
        """
        if not isinstance(self._function, VectorFunction):
            raise InputError(
                "the objective is a scalar: least squares needs one that is the norm of a vector."
            )
        self(designs)
        return np.asarray(self._function.residuals(designs), dtype=np.float64)

    def jacobian(self, designs: FloatArray) -> FloatArray | None:
        """Exact Jacobians (n, r, k) at designs (n, k); None if the function has none."""
        if not isinstance(self._function, DifferentiableVectorFunction):
            return None
        return self._function.jacobian(designs)

    def gradient(self, designs: FloatArray) -> FloatArray | None:
        """Exact gradients (n, k) at designs (n, k); None if the function has none."""
        if not isinstance(self._function, DifferentiableFunction):
            return None
        return self._function.gradient(designs)

    def constrained(self, designs: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return objective values (n,) and excesses (n, c) of designs (n, k).

        There are no columns without constraints.

        BudgetExhausted as for values.
        """
        values = self(designs)
        if not isinstance(self._function, ConstrainedFunction):
            return values, np.zeros((len(designs), 0))
        return self._function.constrained(designs)

    def linearized(self, designs: FloatArray) -> Linearized | None:
        """Return what `constrained` does with the gradients of both, (n, k) and (n, c, k).

        None if the function has none; BudgetExhausted as for values.
        """
        if not isinstance(self._function, LinearizedFunction):
            return None
        designs = normalized(designs)
        limit = self._budget.evaluations
        fresh = first_rows(designs, self._asked)
        if fresh and (limit is None or self.evaluations + len(fresh) <= limit):
            # Values and gradients at once; the values are then known.
            self._check_time()
            if self._function.linearized(designs) is None:
                return None
        self(designs)
        return self._function.linearized(designs)

    def objectives(self, designs: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return values of several objectives (n, m) and excesses (n, c) of designs (n, k).

        InputError if the function has one objective only; BudgetExhausted as for values.
        """
        if not isinstance(self._function, SeveralFunction):
            raise InputError("the function has one objective: this method needs several.")
        self(designs)
        return self._function.objectives(designs)

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

    def _evaluate(
        self, designs: FloatArray, fresh: dict[bytes, int], part: int
    ) -> Generator[int, None, None]:
        """Evaluate what is not known yet, within the budget; yield how many of it are done."""
        limit = self._budget.evaluations
        left = len(fresh) if limit is None else min(limit - self.evaluations, len(fresh))
        if left <= 0:
            raise BudgetExhausted(f"the budget of {limit} evaluations is spent")
        self._check_time()
        keys, rows = list(fresh), list(fresh.values())
        done = 0
        with closing(self._cache.stream(designs[rows[:left]], part)) as parts:
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
        if left < len(fresh):
            raise BudgetExhausted(f"the budget of {limit} evaluations is spent")

    def _note(self, key: bytes, design: FloatArray, value: float) -> None:
        self._asked.add(key)
        if self._first is None:
            self._first = design.copy()
        if value < self.value:
            self.value = value
            self._improvements.append((len(self._asked), value, design.copy()))

    def _check_time(self) -> None:
        seconds = self._budget.seconds
        if seconds is not None and self.evaluations and time.monotonic() - self._began >= seconds:
            raise BudgetExhausted(f"the budget of {seconds:g} s is spent")
