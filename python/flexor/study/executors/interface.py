"""Where designs are evaluated: the interface behind which threads and clusters live."""

from __future__ import annotations

import sys
from abc import ABC, abstractmethod
from collections.abc import Generator
from types import TracebackType
from typing import TYPE_CHECKING

from flexor.study.outcomes import FloatArray, Outcomes
from flexor.study.problem import Problem

if TYPE_CHECKING:
    if sys.version_info >= (3, 11):
        from typing import Self
    else:
        from typing_extensions import Self

# Designs of one part at most: enough to keep every core busy and to outweigh what sending them
# costs, few enough for a progress that moves, and an interruption loses no more.
PART = 256


class Executor(ABC):
    """Evaluates designs somewhere; the outcomes do not depend on where.

    An executor says how one part after another is evaluated (`parts`) and, if more can go on at a
    time, how many (`slots`). It is a context manager for what it may have to let go of (`close`).
    """

    @abstractmethod
    def parts(
        self, problem: Problem, designs: FloatArray, gradient: bool = False
    ) -> Generator[Outcomes, None, None]:
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
        Outcomes
            Of the first designs, the next, and so on, at most ``PART`` of them each. Later parts
            may be evaluated before they are asked for.
        """

    @property
    def slots(self) -> int:
        """How many parts it can evaluate at the same time."""
        return 1

    def evaluate(self, problem: Problem, designs: FloatArray, gradient: bool = False) -> Outcomes:
        """Evaluate designs (n, k); outcomes in their order."""
        parts = list(self.parts(problem, designs, gradient))
        # Without designs there are no parts, but there is still an answer.
        return Outcomes.joined(parts) if parts else problem.evaluate(designs, 1, gradient)

    def close(self) -> None:  # noqa: B027 - most have nothing to let go of
        """Let go of processes and connections."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
