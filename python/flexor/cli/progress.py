"""Live progress of a running search."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from types import TracebackType
from typing import TYPE_CHECKING

from rich.progress import BarColumn, Progress, SpinnerColumn, TaskID, TextColumn

from flexor.cli.console import err
from flexor.cli.table import number

if TYPE_CHECKING:
    if sys.version_info >= (3, 11):
        from typing import Self
    else:
        from typing_extensions import Self

    from flexor.study import StudyProgress


class LiveLine:
    """A transient progress line, shown in terminals only.

    Parameters
    ----------
    first : str
        Initial text.
    """

    def __init__(self, first: str) -> None:
        self._bar = Progress(
            SpinnerColumn(finished_text="●"),
            TextColumn("{task.description}"),
            BarColumn(bar_width=20),
            TextColumn("{task.fields[left]}"),
            console=err,
            transient=True,
        )
        self._shown = False
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
            return
        if not self._shown:
            self._bar.start()
            self._shown = True
        self._bar.update(
            self._task, description=" · ".join(parts), completed=done, total=total, left=left
        )


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
