"""Live progress of a running comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexor.cli.progress import LiveLine, duration

if TYPE_CHECKING:
    from flexor.study.comparison import ComparisonProgress


class ComparisonBar(LiveLine):
    """Shows completed searches, designs per second and the remaining time."""

    def __init__(self) -> None:
        super().__init__("first searches")
        self._before: int | None = None

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
