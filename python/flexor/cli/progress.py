"""Live progress of a running search."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from types import TracebackType
from typing import TYPE_CHECKING

from rich.progress import BarColumn, Progress, SpinnerColumn, TaskID, TextColumn

from flexor.cli.console import err
from flexor.cli.table import number
from flexor.errors import one_line

if TYPE_CHECKING:
    if sys.version_info >= (3, 11):
        from typing import Self
    else:
        from typing_extensions import Self

    from flexor.study import StudyProgress


# Seconds between lines where output is no terminal.
LINE_EVERY = 30.0


class LiveLine:
    """A transient progress line in terminals; elsewhere a line every half minute.

    Parameters
    ----------
    first : str
        Initial text.
    """

    def __init__(self, first: str) -> None:
        self._bar = Progress(
            SpinnerColumn(finished_text="●"),
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=20),
            TextColumn("{task.fields[left]}", markup=False),
            console=err,
            transient=True,
        )
        self._shown = False
        self._next = time.monotonic() + LINE_EVERY
        self._task: TaskID = self._bar.add_task(first, total=None, left="")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._shown:
            self._bar.stop()

    def show(self, parts: Sequence[str], done: int, total: int | None, left: str) -> None:
        """Update the line; it appears on the first call.

        Parameters
        ----------
        parts : sequence of str
            Parts of the text.
        done, total : int
            Progress; a total of None is unknown.
        left : str
            Remaining time.
        """
        if not err.is_interactive:
            self._log(parts, left)
            return
        if not self._shown:
            self._bar.start()
            self._shown = True
        self._bar.update(
            self._task,
            description=one_line(" · ".join(parts)),
            completed=done,
            total=total,
            left=left,
        )

    def _log(self, parts: Sequence[str], left: str) -> None:
        """Print a line now and then where there is no terminal."""
        now = time.monotonic()
        if now >= self._next:
            self._next = now + LINE_EVERY
            err.print(" · ".join([*parts, left] if left else parts), soft_wrap=True)


class SearchProgress(LiveLine):
    """Shows the best value, evaluations, designs per second and the remaining time."""

    def __init__(self) -> None:
        super().__init__("first designs")

    def __call__(self, at: StudyProgress) -> None:
        """Update the line with the state of the search."""
        parts = ["all designs failed so far"]
        if at.best is not None:
            objective = at.best.problem.objective
            shown = f"{number(at.best.shown)} {objective.unit}".rstrip()
            parts = [f"best {objective.quantity} {shown}"]
        parts.append(f"{at.evaluations:,} designs")
        if at.rate:
            parts.append(f"{at.rate:,.0f}/s")
        total = None if at.remaining is None else at.evaluations + at.remaining
        left = "" if at.seconds_left is None else f"{duration(at.seconds_left)} left"
        self.show(parts, at.evaluations, total, left)


def duration(seconds: float) -> str:
    """Format a duration.

    Parameters
    ----------
    seconds : float
        Duration [s].
    """
    if seconds < 10.0:
        return f"{seconds:.1f} s"
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    if seconds < 7200.0:
        return f"{seconds / 60.0:.0f} min"
    return f"{seconds / 3600.0:.1f} h"
