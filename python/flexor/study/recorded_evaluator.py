"""The batch function of a study: evaluates what is not in the record and records it."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import closing

import numpy as np

from flexor.model.results import Paths
from flexor.optimizers.cached_evaluator import CachedEvaluator, normalized
from flexor.study.executors import DesignEvaluator
from flexor.study.problem import FloatArray, Problem
from flexor.study.record import Record


class RecordedEvaluator(CachedEvaluator):
    """From designs (n, k) to ranks (n,), which are the values of feasible ones, through the record.

    Known designs are answered from the record, the others are evaluated and appended in one
    transaction for each chunk. A deterministic search that is simply run again therefore finds its
    way to where it was interrupted without evaluating anything twice.

    If the search asks for ``gradients``, every design is differentiated as it is evaluated, for a
    twentieth of the time, and its derivatives are recorded with it.
    """

    def __init__(
        self, problem: Problem, record: Record, executor: DesignEvaluator, gradients: bool = False
    ) -> None:
        super().__init__(self, record.known())
        self._problem, self._record, self._executor = problem, record, executor
        self._gradients = gradients and problem.differentiable

    def residuals(self, designs: FloatArray) -> FloatArray:
        """Vectors (n, r) of designs (n, k), from the record; NaN for those that failed."""
        self(designs)
        vectors = [self._problem.residuals(self._record.outcomes(design)) for design in designs]
        return np.concatenate(vectors)

    def gradient(self, designs: FloatArray) -> FloatArray | None:
        """Gradients (n, k) at designs (n, k); NaN for those that failed.

        None if the search was not to have them or the objective has none.
        """
        if not self._gradients:
            return None
        paths = self._differentiated(designs)
        found = self._problem.gradients(paths)
        return np.where((paths.violation > 0.0)[:, None], np.nan, found)

    def constrained(self, designs: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return objective values (n,) and excesses (n, c) at designs (n, k), from the record.

        +inf and NaN for those that failed.
        """
        self(designs)
        rows = [self._record.outcomes(design) for design in normalized(designs)]
        values = np.concatenate([row.value for row in rows])
        found = np.concatenate([self._problem.excesses(row) for row in rows])
        return values, np.where(np.isfinite(values)[:, None], found, np.nan)

    def linearized(
        self, designs: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray] | None:
        """Return `constrained` with the gradients of both, (n, k) and (n, c, k), per SI unit.

        Designs that are not known yet are differentiated as they are evaluated. None if the
        objective or a constraint has no derivative.
        """
        if not self._problem.linearizable:
            return None
        asked, self._gradients = self._gradients, True
        try:
            paths = self._differentiated(designs)
        finally:
            self._gradients = asked
        problem, values = self._problem, paths.value
        excesses = np.where(np.isfinite(values)[:, None], problem.excesses(paths), np.nan)
        return values, excesses, problem.gradients(paths), problem.excess_gradients(paths)

    def objectives(self, designs: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return values of several objectives (n, m) and excesses (n, c), from the record.

        +inf and NaN for those that failed.
        """
        _, found = self.constrained(designs)
        rows = [self._record.outcomes(design) for design in normalized(designs)]
        values = np.concatenate([row.objective_values for row in rows])
        return np.where(np.isnan(values), np.inf, values), found

    def jacobian(self, designs: FloatArray) -> FloatArray | None:
        """Jacobians (n, r, k) of the vectors at designs (n, k); NaN for those that failed.

        None if the search was not to have them or the objective has none.
        """
        if not (self._gradients and self._problem.objective.residual_differentiable):
            return None
        return self._problem.jacobians(self._differentiated(designs))

    def _evaluate(self, designs: FloatArray, part: int) -> Generator[FloatArray, None, None]:
        """Yield values of designs that are not known yet, each recorded before it is seen."""
        with closing(self._parts(designs, self._gradients)) as parts:
            for chunk, paths in parts:
                self._record.append(chunk, paths)
                yield self._problem.ranks(paths)

    def _parts(
        self, designs: FloatArray, gradients: bool
    ) -> Generator[tuple[FloatArray, Paths], None, None]:
        """Evaluate designs; yield those of each chunk with their paths."""
        done = 0
        with closing(self._executor.parts(self._problem, designs, gradients)) as parts:
            for paths in parts:
                yield designs[done : done + len(paths)], paths
                done += len(paths)

    def _differentiated(self, designs: FloatArray) -> Paths:
        """Paths with derivatives, from the record."""
        designs = normalized(designs)
        self(designs)
        found = [self._record.outcomes(row) for row in designs]
        missing = np.array(
            [paths.derivatives is None and paths.value_gradient is None for paths in found]
        )
        if missing.any():  # recorded by a search that had no use for them
            for part, paths in self._parts(designs[missing], True):
                self._record.append_derivatives(part, paths)
            found = [self._record.outcomes(row) for row in designs]
        return Paths.concatenate(found)
