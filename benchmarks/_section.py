"""Report of a benchmark: a section of `docs/performance.md`, or terminal output."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from _machine import machine
from rich.console import Console
from rich.table import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Missing(Exception):
    """A tool or package required by a benchmark is missing."""


@dataclass
class Section:
    """A heading with text, tables and at most one figure.

    Attributes
    ----------
    title, command
        The heading, and the command that produces this section.
    parts : list of str or Table
        Paragraphs and tables.
    figure : Figure or None
        The figure, and `caption` below it.
    """

    title: str
    command: str
    parts: list[str | Table] = field(default_factory=list)
    figure: Figure | None = None
    caption: str = ""

    def show(self) -> None:
        """Print it."""
        console = Console()
        for part in self.parts:
            console.print(part, markup=False) if isinstance(part, str) else console.print(part)

    def report(self) -> None:
        """Print it below a line that describes the machine."""
        Console().print(machine(), markup=False)
        self.show()

    def markdown(self, image: str | None = None) -> str:
        """Format it as Markdown, with the figure at a path relative to the document."""
        lines = [f"## {self.title}", "", f"`{self.command}`", ""]
        for part in self.parts:
            lines += [part if isinstance(part, str) else _markdown(part), ""]
        if image is not None:
            lines += [f"![{self.caption}]({image})", "", f"*{self.caption}*", ""]
        return "\n".join(lines)

    def save(self, file: Path) -> None:
        """Write the figure, if there is one."""
        if self.figure is not None:
            from flexor import plot

            plot.save(self.figure, file)


def table(*columns: str, text: int = 1) -> Table:
    """Create a table with `text` left-aligned columns of text, followed by numbers."""
    result = Table(*columns)
    for column in result.columns[text:]:
        column.justify = "right"
    return result


def _markdown(result: Table) -> str:
    head = [str(column.header) for column in result.columns]
    rule = ["--:" if column.justify == "right" else "---" for column in result.columns]
    rows = zip(*([str(cell) for cell in column.cells] for column in result.columns), strict=True)
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (head, rule, *rows))
