"""Evaluation in this process, on its threads."""

from __future__ import annotations

import os
from collections.abc import Generator
from dataclasses import dataclass

from flexor.model.chunks import chunks
from flexor.model.results import Paths
from flexor.study.executors.interface import Executor
from flexor.study.problem import FloatArray, Problem


@dataclass(frozen=True)
class Threads(Executor):
    """Evaluates in this process.

    Attributes
    ----------
    threads : int
        Threads of the engine; 0 for one per core.
    """

    threads: int = 0

    @property
    def slots(self) -> int:
        """How many parts keep every core busy."""
        cores = os.cpu_count() or 1
        return max(cores // (self.threads or cores), 1)

    def parts(
        self, problem: Problem, designs: FloatArray, gradient: bool = False
    ) -> Generator[Paths, None, None]:
        """Evaluate designs (n, k), one part after the other, each on all threads."""
        for chunk in chunks(len(designs)):
            yield problem.evaluate(designs[chunk], self.threads, gradient)
