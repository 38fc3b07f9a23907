"""The interface of what evaluates designs, and the one that uses threads of this process."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from flexor.model.chunks import chunks
from flexor.model.results import Paths
from flexor.model.solver import useful_threads
from flexor.study.problem import FloatArray, Problem

if TYPE_CHECKING:
    from typing_extensions import Self

Result = TypeVar("Result")


class DesignEvaluator(ABC):
    """Evaluates designs; results do not depend on the executor.

    A context manager for what it may have to close.
    """

    @abstractmethod
    def parts(
        self, problem: Problem, designs: FloatArray, gradient: bool = False
    ) -> Generator[Paths, None, None]:
        """Evaluate designs, part after part.

        Yields the paths of the first designs (n, k), SI, of the next, and so on, of at most
        `flexor.model.chunks.SIZE` each, and with derivatives if ``gradient``. Later parts may be
        evaluated before they are asked for.
        """

    @property
    def slots(self) -> int:
        """How many parts it can evaluate at the same time."""
        return 1

    def evaluate(self, problem: Problem, designs: FloatArray, gradient: bool = False) -> Paths:
        """Evaluate designs (n, k); outcomes in their order."""
        parts = list(self.parts(problem, designs, gradient))
        # Without designs there are no parts, but there is still an answer.
        return Paths.concatenate(parts) if parts else problem.evaluate(designs, 1, gradient)

    @property
    def remote(self) -> bool:
        """Whether `call` is answered elsewhere, where nothing of this process is seen."""
        return False

    def call(
        self,
        problem: object,
        function: Callable[..., Result],
        *arguments: Any,
        stopped: Callable[[], bool] | None = None,
    ) -> Result:
        """Return ``function(problem, *arguments)``, called where designs are evaluated.

        The result must be something that can be pickled. CancelledError may be raised once
        ``stopped`` returns True, since the result is no longer wanted.
        """
        return function(problem, *arguments)

    def close(self) -> None:  # noqa: B027 - most have nothing to close
        """Close processes and connections that were opened here."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


@dataclass(frozen=True)
class Threads(DesignEvaluator):
    """Evaluates in this process; InputError if the number of threads is not useful."""

    threads: int = 0  # of the engine; 0 for one per core

    def __post_init__(self) -> None:
        useful_threads(self.threads)

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
