"""The live line of a running search."""

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
    """A line that is written anew with all news, in terminals only; gone at the end.

    Parameters
    ----------
    first : str
        What it says until the first news.
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
        """Write the line; it appears when this is first called.

        Parameters
        ----------
        parts : sequence of str
            What it says.
        done, total : int
            Length of the bar; a total of None is not known.
        left : str
            The time left, in words.
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
    """Shows best so far, evaluations, designs per second and the time left, while in use."""

    def __init__(self) -> None:
        super().__init__("first designs")

    def __call__(self, at: StudyProgress) -> None:
        """Take in where the search stands."""
        parts = ["every design failed so far"]
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
    """Return a time as people say it.

    Parameters
    ----------
    seconds : float
        How long [s].
    """
    if seconds < 10.0:
        return f"{seconds:.1f} s"
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    if seconds < 7200.0:
        return f"{seconds / 60.0:.0f} min"
    return f"{seconds / 3600.0:.1f} h"
