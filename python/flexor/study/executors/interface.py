"""Where designs are evaluated: the interface of threads, pools and clusters."""

from __future__ import annotations

import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator
from types import TracebackType
from typing import TYPE_CHECKING, Any, TypeVar

from flexor.model.results import Paths
from flexor.study.problem import FloatArray, Problem

if TYPE_CHECKING:
    if sys.version_info >= (3, 11):
        from typing import Self
    else:
        from typing_extensions import Self

Result = TypeVar("Result")


class Executor(ABC):
    """Evaluates designs somewhere; the outcomes do not depend on where.

    A context manager for what it may have to close.
    """

    @abstractmethod
    def parts(
        self, problem: Problem, designs: FloatArray, gradient: bool = False
    ) -> Generator[Paths, None, None]:
        """Evaluate designs (n, k), part after part.

        Parameters
        ----------
        problem : Problem
            Whose designs they are.
        designs : (n, k) array
            Designs, SI.
        gradient : bool
            Whether to differentiate them as well.

        Yields
        ------
        Paths
            Of the first designs, the next, and so on, at most `flexor.model.chunks.SIZE` of them
            each. Later parts may be evaluated before they are asked for.
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
        problem: Problem,
        function: Callable[..., Result],
        *arguments: Any,
        stopped: Callable[[], bool] | None = None,
    ) -> Result:
        """Call a function of a problem where its designs are evaluated, such as a whole search.

        Parameters
        ----------
        problem : Problem
            Its first argument.
        function : callable
            From the problem and the other arguments to something that can be pickled.
        *arguments
            The other arguments.
        stopped : callable, optional
            Says whether nobody waits for the result any more; then CancelledError may be raised.
        """
        return function(problem, *arguments)

    def close(self) -> None:  # noqa: B027 - most have nothing to close
        """Close processes and connections that were opened here."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
