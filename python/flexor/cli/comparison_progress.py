"""The live line of a running comparison."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING

from rich.progress import BarColumn, Progress, SpinnerColumn, TaskID, TextColumn

from flexor.cli.console import err
from flexor.cli.progress import duration

if TYPE_CHECKING:
    from flexor.survey import ComparisonProgress


class ComparisonBar:
    """Shows searches done, designs per second and the time left, while in use."""

    def __init__(self) -> None:
        self._bar = Progress(
            SpinnerColumn(finished_text="●"),
            TextColumn("{task.description}"),
            BarColumn(bar_width=20),
            TextColumn("{task.fields[left]}"),
            console=err,
            transient=True,
        )
        self._task: TaskID = self._bar.add_task("first searches", total=None, left="")
        self._before: int | None = None
        self._shown = False

    def __enter__(self) -> ComparisonBar:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._shown:
            self._bar.stop()

    def __call__(self, at: ComparisonProgress) -> None:
        """Take in where the comparison stands; the line appears with the first news."""
        if not self._shown:
            if not err.is_interactive:
                return
            self._bar.start()
            self._shown = True
        if self._before is None:
            self._before = at.done  # of an earlier run: they say nothing about the time left
        parts = [f"{at.done} of {at.total} searches"]
        if at.rate:
            parts.append(f"{at.rate:,.0f} designs/s")
        if at.last:
            parts.append(at.last)
        now = at.done - self._before
        left = f"{duration(at.seconds / now * (at.total - at.done))} left" if now else ""
        self._bar.update(
            self._task,
            description=" · ".join(parts),
            completed=at.done,
            total=at.total,
            left=left,
        )
