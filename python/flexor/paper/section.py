"""What an item of the study comes to, before it is a page: words, numbers, tables and pictures."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Cell = str | int | float | bool | None


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes
    ----------
    heading : str
        What stands in it.
    unit : str
        Unit of its numbers, as shown.
    digits : int
        Significant digits of its numbers as shown; files have all of them.
    timing : bool
        Whether it holds times, which differ from run to run.
    """

    heading: str
    unit: str = ""
    digits: int = 4
    timing: bool = False

    @property
    def title(self) -> str:
        """Heading and unit."""
        return f"{self.heading} / {self.unit}" if self.unit else self.heading

    def shown(self, cell: Cell) -> str:
        """Return a cell as people read it."""
        if cell is None:
            return "–"
        if isinstance(cell, bool):
            return "yes" if cell else "no"
        if isinstance(cell, int):
            return f"{cell:,}"
        if isinstance(cell, float):
            return number(cell, self.digits)
        return cell


@dataclass(frozen=True)
class Table:
    """A table, written as CSV and shown in the report.

    Attributes
    ----------
    name : str
        Name of its file, without ending.
    caption : str
        What it shows, one sentence or two.
    columns : tuple of Column
        Its columns.
    rows : tuple of tuple of Cell
        Its cells, as many in each row as there are columns.
    brief : bool
        Whether it is short enough for the summary in the documentation.
    """

    name: str
    caption: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    brief: bool = True


@dataclass(frozen=True)
class Compared:
    """A published number beside ours.

    Attributes
    ----------
    what : str
        What it is.
    place : str
        Where it stands in the paper.
    published : float or None
        In the shown unit; None if the paper gives no number.
    ours : float
        In the same unit.
    unit : str
        Unit, as shown.
    """

    what: str
    place: str
    published: float | None
    ours: float
    unit: str = ""

    @property
    def difference(self) -> float | None:
        """Ours minus published."""
        return None if self.published is None else self.ours - self.published

    @property
    def percent(self) -> float | None:
        """The difference as a part of the published number [%]; None if that is zero."""
        if self.published is None or self.published == 0.0:
            return None
        return 100.0 * (self.ours - self.published) / abs(self.published)


@dataclass(frozen=True)
class Picture:
    """A figure, written as PNG and SVG and shown in the report.

    Attributes
    ----------
    name : str
        Name of its files, without ending.
    caption : str
        What it shows.
    figure : matplotlib.figure.Figure
        The figure.
    """

    name: str
    caption: str
    figure: Figure = field(repr=False)


@dataclass(frozen=True)
class Section:
    """An item of the study, as the report shows it.

    Attributes
    ----------
    name, title : str
        As asked for with `--only`, and as read.
    text : tuple of str
        Paragraphs in plain words.
    compared : tuple of Compared
        Published numbers beside ours.
    tables : tuple of Table
        Its tables.
    pictures : tuple of Picture
        Its figures.
    """

    name: str
    title: str
    text: tuple[str, ...] = ()
    compared: tuple[Compared, ...] = ()
    tables: tuple[Table, ...] = ()
    pictures: tuple[Picture, ...] = ()

    @property
    def all_tables(self) -> tuple[Table, ...]:
        """Its tables, that of the published numbers first."""
        return (comparison_table(self), *self.tables) if self.compared else self.tables


def comparison_table(section: Section) -> Table:
    """Return the table of a section's published numbers beside ours."""
    return Table(
        name=f"{section.name}-published",
        caption="Published numbers beside ours.",
        brief=len(section.compared) <= 12,
        columns=(
            Column("quantity"),
            Column("unit"),
            Column("place in the paper"),
            Column("published"),
            Column("ours"),
            Column("difference", digits=3),
            Column("difference", "%", digits=3),
        ),
        rows=tuple(
            (each.what, each.unit, each.place, each.published, each.ours, each.difference,
             each.percent)
            for each in section.compared
        ),
    )  # fmt: skip


def number(value: float, digits: int = 4) -> str:
    """Return a number with so many significant digits, without trailing zeros or -0.

    Parameters
    ----------
    value : float
        What to show.
    digits : int
        Significant digits; whole numbers keep all of theirs. What rounding leaves of a zero is
        shown as zero.
    """
    if not math.isfinite(value):
        return "–" if math.isnan(value) else ("∞" if value > 0.0 else "-∞")
    if abs(value) < 1e-12:
        return "0"
    if not 1e-4 <= abs(value) < 1e6:
        return f"{value:.{digits}g}"
    size = math.floor(math.log10(abs(value)))
    text = f"{value:.{max(digits - 1 - size, 0)}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return text
