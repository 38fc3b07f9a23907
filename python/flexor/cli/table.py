"""Tables in the terminal."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rich import box
from rich.cells import cell_len
from rich.table import Table

from flexor.cli.console import out, plain

LONGEST = 24  # letters of a word that are kept on one line
_BETWEEN, _EDGES = 3, 2  # columns of the terminal between and around those of a table


def table(headings: Sequence[str], rows: Iterable[Sequence[str]], *, left: int = 1) -> Table:
    """Create a table whose first columns, and others of text, are left-aligned.

    A unit after " / " in a heading goes onto its own line. In a narrow terminal headings and
    columns of text are wrapped, numbers are not.
    """
    result = Table(box=box.SIMPLE_HEAD, pad_edge=False, header_style="bold")
    rows = [tuple(row) for row in rows]
    columns = [
        _Column.of(heading, [row[i] for row in rows], i < left)
        for i, heading in enumerate(headings)
    ]
    for column, width in zip(columns, _widths(columns), strict=True):
        result.add_column(
            plain(column.heading),
            justify="left" if column.text else "right",
            overflow="fold",
            width=width,
        )
    for row in rows:
        result.add_row(*map(plain, row))
    return result


def show(headings: Sequence[str], rows: Iterable[Sequence[str]], *, left: int = 1) -> None:
    """Print a table to stdout; see `table`.

    Columns that do not fit go into further tables below, each with the first column again. Of a
    column that is too wide by itself, lines exceed the width of the terminal rather than being
    cropped.
    """
    rows = [tuple(row) for row in rows]
    for columns in _fitting(headings, rows, left):
        chosen = [[row[column] for column in columns] for row in rows]
        result = table([headings[column] for column in columns], chosen, left=left)
        result.width = _total([each.width or 0 for each in result.columns])
        out.print(result, crop=False)


@dataclass(frozen=True)
class _Column:
    """A column: its heading in lines, and the least and greatest width that it can use."""

    heading: str
    text: bool
    least: int
    greatest: int

    @classmethod
    def of(cls, heading: str, cells: Sequence[str], first: bool) -> _Column:
        broken = _broken(heading).replace(" / ", "\n")
        lines = [line for text in (broken, *cells) for line in text.split("\n")]
        words = [word for line in lines for word in line.split()]
        least = min(LONGEST, max(map(cell_len, words), default=0))
        text = first or any(map(_is_text, cells))
        if not text:
            least = max([least, *map(cell_len, cells)])
        return cls(broken, text, least, max(map(cell_len, lines), default=0))


def _widths(columns: Sequence[_Column]) -> list[int]:
    """Return the width of each column: all that it can use, or its share of the terminal."""
    widths = [max(each.least, each.greatest) for each in columns]
    while _total(widths) > out.width:
        slack = [width - each.least for width, each in zip(widths, columns, strict=True)]
        # Headings of numbers are wrapped before texts are.
        spare = [0 if each.text else more for more, each in zip(slack, columns, strict=True)]
        slack = spare if any(spare) else slack
        if not any(slack):
            break
        widths[slack.index(max(slack))] -= 1
    return widths


def _total(widths: Sequence[int]) -> int:
    return sum(widths) + _BETWEEN * (len(widths) - 1) + _EDGES


def _fitting(
    headings: Sequence[str], rows: Sequence[Sequence[str]], left: int
) -> list[tuple[int, ...]]:
    """Return the columns of each table, as few tables as fit the width of the terminal."""
    every = tuple(range(len(headings)))
    least = [
        _Column.of(heading, [row[i] for row in rows], i < left).least
        for i, heading in enumerate(headings)
    ]
    repeated, parts = every[: max(left, 1)], list[tuple[int, ...]]()
    current = repeated
    for column in every[len(repeated) :]:
        wider = (*current, column)
        if len(current) > len(repeated) and _total([least[i] for i in wider]) > out.width:
            parts.append(current)
            wider = (*repeated, column)
        current = wider
    return [*parts, current]


def _broken(heading: str) -> str:
    """Break names that are too long for a line after their dots."""
    words = []
    for word in heading.split(" "):
        lines = [""]
        for part in word.replace(".", ".\n").split("\n"):
            if lines[-1] and len(lines[-1] + part) > LONGEST:
                lines.append("")
            lines[-1] += part
        words.append("\n".join(lines))
    return " ".join(words)


def _is_text(cell: str) -> bool:
    """Whether a cell is neither empty nor begins as a number or its sign does."""
    return cell[:1].isalpha() and cell != "nan"


def fixed(value: float, decimals: int = 2) -> str:
    """Format a number with fixed decimals, without -0."""
    text = f"{value:.{decimals}f}"
    return text.removeprefix("-") if float(text) == 0.0 else text


def number(value: float, digits: int = 4) -> str:
    """Format a number to significant digits, without trailing zeros or -0."""
    text = f"{value:.{digits}g}"
    return "0" if float(text) == 0.0 else text


def with_unit(value: float, unit: str) -> str:
    """Return a number with its unit, which may be empty."""
    return f"{number(value)} {unit}".rstrip()


def numbers(values: Iterable[float], least: Iterable[float]) -> list[str]:
    """Format a column of numbers, in which what is less than it is known to is 0.

    ``least`` has the accuracy of each number; see `flexor.model.accuracy`.
    """
    rows = zip(values, least, strict=True)
    return ["0" if abs(value) < least else number(value) for value, least in rows]


def stated(values: Iterable[float]) -> list[str]:
    """Format a column of numbers that were given, which steps between them round."""
    values = list(values)
    largest = max((abs(value) for value in values if math.isfinite(value)), default=0.0)
    return numbers(values, [1e-14 * largest] * len(values))
