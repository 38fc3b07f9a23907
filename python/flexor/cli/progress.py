"""Live progress of running work."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, ClassVar

from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn

from flexor.cli.console import err, note, plain
from flexor.cli.table import number
from flexor.errors import one_line

if TYPE_CHECKING:
    from typing_extensions import Self

    from flexor.calibration import Progress as FitProgress
    from flexor.study import StudyProgress
    from flexor.study.comparison import ComparisonProgress

# Seconds between lines if output is not a terminal.
LINE_EVERY = 30.0
# Seconds that a part of the work takes before it is named there.
NOTE_AFTER = 1.5


class LiveLine:
    """A transient progress line in terminals; elsewhere a line every half minute."""

    first: ClassVar[str] = ""  # what is said before there is any progress

    def __init__(self) -> None:
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
        self._task = self._bar.add_task(self.first, total=None, left="")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def stop(self) -> None:
        """Remove the line."""
        if self._shown:
            self._bar.stop()

    def show(self, parts: Sequence[str], done: int, total: int | None, left: str) -> None:
        """Update the text, how much is done (of an unknown total if None) and the time left."""
        if not err.is_interactive:
            now = time.monotonic()
            if now >= self._next:
                self._next = now + LINE_EVERY
                note(" · ".join([*parts, left] if left else parts))
            return
        if not self._shown:
            self._bar.start()
            self._shown = True
        text = one_line(" · ".join(parts))
        self._bar.update(self._task, description=text, completed=done, total=total, left=left)


class _Notes:
    """Notes of parts of the work, each once it has taken a while."""

    def __init__(self) -> None:
        self._timer: threading.Timer | None = None

    def __call__(self, text: str) -> None:
        self._stop()
        self._timer = threading.Timer(NOTE_AFTER, note, (f"{text} …",))
        self._timer.daemon = True
        self._timer.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stop()

    def _stop(self) -> None:
        if self._timer is not None:
            self._timer.cancel()


@contextmanager
def working(text: str, at_once: bool = True) -> Iterator[Callable[[str], None]]:
    """Say what is being done, which takes a while: a line that goes away, or ones that stay.

    Yields a function that says what is done next. Where lines stay, only of what takes long, as of
    all of it if not ``at_once``.
    """
    if not err.is_interactive:
        with _Notes() as notes:
            if at_once:
                note(f"{text} …")
            else:
                notes(text)
            yield lambda more: notes(f"  {more}")
        return
    with err.status(plain(text)) as status:
        yield lambda more: status.update(plain(f"{text}: {more}"))


class SearchProgress(LiveLine):
    """Shows the best value, evaluations, designs per second and the remaining time."""

    first = "first designs"

    def __call__(self, at: StudyProgress) -> None:
        """Update the line with the state of the search."""
        best = "all designs failed so far"
        if at.best is not None:
            best = f"best {at.best.result}{'' if at.best.feasible else ', not feasible'}"
        parts = [*([at.stage] if at.stage else []), best, f"{at.evaluations:,} designs"]
        if at.rate:
            parts.append(f"{at.rate:,.0f}/s")
        total = None if at.remaining is None else at.evaluations + at.remaining
        left = ""
        if at.seconds_left is not None and at.seconds_left >= 0.05:
            # Others may follow a stage.
            left = f"{duration(at.seconds_left)} left{' of it' if at.stage else ''}"
        self.show(parts, at.evaluations, total, left)


class ComparisonBar(LiveLine):
    """Shows completed searches, designs per second and the remaining time."""

    first = "first searches"
    _before: int | None = None

    def __call__(self, at: ComparisonProgress) -> None:
        """Update the line with the state of the comparison."""
        if self._before is None:
            self._before = at.done  # from an earlier run; excluded from the time estimate
        parts = [f"{at.done} of {at.total} searches"]
        if at.rate:
            parts.append(f"{at.rate:,.0f} designs/s")
        if at.last:
            parts.append(at.last)
        now = at.done - self._before
        left = f"{duration(at.seconds / now * (at.total - at.done))} left" if now else ""
        self.show(parts, at.done, at.total, left)


class CalibrationBar(LiveLine):
    """Shows the stage of a calibration, its evaluations and its misfit."""

    first = "reading"

    def __call__(self, at: FitProgress) -> None:
        """Update the line with the state of the calibration."""
        parts = [at.stage, f"{at.evaluated + at.replayed:,} evaluations"]
        if math.isfinite(at.misfit):
            parts.append(f"misfit {number(at.misfit, 3)}")
        self.show(parts, at.done, at.total, "")


def duration(seconds: float) -> str:
    """Format a duration."""
    if seconds < 10.0:
        return f"{seconds:.1f} s"
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    if seconds < 7200.0:
        return f"{seconds / 60.0:.0f} min"
    return f"{seconds / 3600.0:.1f} h"
