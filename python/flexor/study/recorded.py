"""The batch function of a study: evaluates what is not in the record and records it."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import closing
from dataclasses import replace

import numpy as np

from flexor.study.executors import Executor
from flexor.study.outcomes import FloatArray, Outcomes
from flexor.study.problem import Problem
from flexor.study.record import Record


class Recorded:
    """From designs (n, k) to values (n,), through the record.

    Known designs (by their exact bytes) are answered from the record, the others are evaluated and
    appended in one transaction for each part. A deterministic search that is simply run again
    therefore finds its way to where it was interrupted without evaluating anything twice.

    Parameters
    ----------
    problem : Problem
        What is evaluated.
    record : Record
        Where it is kept.
    executor : Executor
        Where it is evaluated.
    gradients : bool
        Whether the search asks for gradients. Then every design is differentiated as it is
        evaluated, for a twentieth of the time, and its derivatives are recorded with it.

    Attributes
    ----------
    evaluated, replayed : int
        Designs evaluated now, and designs answered from what an earlier run had recorded.
    """

    def __init__(
        self, problem: Problem, record: Record, executor: Executor, gradients: bool = False
    ) -> None:
        self._problem, self._record, self._executor = problem, record, executor
        self._gradients = gradients and problem.differentiable
        self._known = record.known()
        self._earlier = set(self._known)
        self.evaluated = 0
        self.replayed = 0

    def __call__(self, designs: FloatArray) -> FloatArray:
        """Values of designs (n, k); +inf for those that failed."""
        return np.concatenate([np.zeros(0), *self.stream(designs)])

    def stream(self, designs: FloatArray) -> Generator[FloatArray, None, None]:
        """Yield values of designs (n, k), part after part, each recorded before it is seen."""
        designs = np.ascontiguousarray(designs, dtype="<f8") + 0.0  # one kind of zero
        keys = [row.tobytes() for row in designs]
        fresh: dict[bytes, int] = {}
        for row, key in enumerate(keys):
            if key in self._known:
                if key in self._earlier:
                    self._earlier.remove(key)
                    self.replayed += 1
            else:
                fresh.setdefault(key, row)
        rows = [*fresh.values(), len(designs)]
        told, done = 0, 0
        with closing(self._parts(designs[rows[:-1]])) as parts:
            for part, outcomes in parts:
                self._record.append(part, outcomes)
                for row, value in zip(part, outcomes.value.tolist(), strict=True):
                    self._known[row.tobytes()] = value
                self.evaluated += len(part)
                done += len(part)
                # All up to the next that is not known yet.
                yield np.array([self._known[key] for key in keys[told : rows[done]]])
                told = rows[done]
        if told < len(keys):
            yield np.array([self._known[key] for key in keys[told:]])

    def residuals(self, designs: FloatArray) -> FloatArray:
        """Vectors (n, r) of designs (n, k), from the record; NaN for those that failed.

        Raises
        ------
        InputError
            If the objective is not the norm of a vector.
        """
        self(designs)
        vectors = [self._problem.residuals(self._record.outcomes(design)) for design in designs]
        return np.concatenate(vectors)

    def gradient(self, designs: FloatArray) -> FloatArray | None:
        """Gradients (n, k) at designs (n, k); NaN for those that failed.

        None if the search was not to have them or the objective has none.
        """
        if not self._gradients:
            return None
        return self._problem.gradients(self._differentiated(designs))

    def jacobian(self, designs: FloatArray) -> FloatArray | None:
        """Jacobians (n, r, k) of the vectors at designs (n, k); NaN for those that failed.

        None if the search was not to have them or the objective has none.
        """
        if not (self._gradients and self._problem.objective.residual_differentiable):
            return None
        return self._problem.jacobians(self._differentiated(designs))

    def _parts(self, designs: FloatArray) -> Generator[tuple[FloatArray, Outcomes], None, None]:
        """Evaluate designs; yield those of each part with their outcomes."""
        done = 0
        with closing(self._executor.parts(self._problem, designs, self._gradients)) as parts:
            for outcomes in parts:
                yield designs[done : done + len(outcomes)], outcomes
                done += len(outcomes)

    def _differentiated(self, designs: FloatArray) -> Outcomes:
        """Outcomes with derivatives, from the record."""
        designs = np.ascontiguousarray(designs, dtype="<f8") + 0.0
        self(designs)
        bare = [row for row in designs if self._record.derivatives(row) is None]
        if bare:  # recorded by a search that had no use for them
            for part, outcomes in self._parts(np.array(bare)):
                self._record.append_derivatives(part, outcomes)
        parts = []
        for row in designs:
            found = self._record.derivatives(row)
            assert found is not None
            slopes, regularity = found
            parts.append(
                replace(
                    self._record.outcomes(row),
                    derivatives=slopes[None],
                    regularity=np.array([regularity], dtype=object),
                )
            )
        return Outcomes.joined(parts)
