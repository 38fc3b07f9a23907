"""What a benchmark found: a section of `docs/performance.md`, or lines of a terminal."""

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
    """What a section needs and is not there."""


@dataclass
class Section:
    """A heading, then text, tables and at most one figure, in the order in which they came.

    Attributes
    ----------
    title, command
        The heading, and what to run to get this section alone.
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
        """Print it below a line on where it was measured."""
        Console().print(machine(), markup=False)
        self.show()

    def markdown(self, image: str | None = None) -> str:
        """Write it, with the figure at a path as the document sees it."""
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
    """Begin a table whose columns are numbers, but for the first `text` of them."""
    made = Table(*columns)
    for column in made.columns[text:]:
        column.justify = "right"
    return made


def _markdown(made: Table) -> str:
    head = [str(column.header) for column in made.columns]
    rule = ["--:" if column.justify == "right" else "---" for column in made.columns]
    rows = zip(*([str(cell) for cell in column.cells] for column in made.columns), strict=True)
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (head, rule, *rows))
