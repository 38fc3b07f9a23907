"""The live line of a running comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexor.cli.progress import LiveLine, duration

if TYPE_CHECKING:
    from flexor.study.comparison import ComparisonProgress


class ComparisonBar(LiveLine):
    """Shows searches done, designs per second and the time left, while in use."""

    def __init__(self) -> None:
        super().__init__("first searches")
        self._before: int | None = None

    def __call__(self, at: ComparisonProgress) -> None:
        """Take in where the comparison stands."""
        if self._before is None:
            self._before = at.done  # of an earlier run: they say nothing about the time left
        parts = [f"{at.done} of {at.total} searches"]
        if at.rate:
            parts.append(f"{at.rate:,.0f} designs/s")
        if at.last:
            parts.append(at.last)
        now = at.done - self._before
        left = f"{duration(at.seconds / now * (at.total - at.done))} left" if now else ""
        self.show(parts, at.done, at.total, left)
