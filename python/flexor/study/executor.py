"""Where designs are evaluated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from flexor.study.outcomes import FloatArray, Outcomes
from flexor.study.problem import Problem


class Executor(Protocol):
    """Evaluates batches of designs somewhere."""

    def evaluate(self, problem: Problem, designs: FloatArray, gradient: bool = False) -> Outcomes:
        """Evaluate designs (n, k); outcomes in their order, the same wherever it happens.

        ``gradient`` asks for their derivatives as well.
        """
        ...


@dataclass(frozen=True)
class Threads:
    """Evaluates in this process.

    Attributes
    ----------
    threads : int
        Threads of the engine; 0 for one per core.
    """

    threads: int = 0

    def evaluate(self, problem: Problem, designs: FloatArray, gradient: bool = False) -> Outcomes:
        """Evaluate designs (n, k)."""
        return problem.evaluate(designs, self.threads, gradient)
