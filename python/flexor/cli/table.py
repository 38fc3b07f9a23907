"""Tables in the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rich import box
from rich.table import Table

from flexor.cli.console import out, plain


def table(headings: Sequence[str], rows: Iterable[Sequence[str]], *, left: int = 1) -> Table:
    """Create a table whose first columns are left-aligned.

    A unit after " / " in a heading goes onto its own line. In a narrow terminal columns of text
    are wrapped, columns of numbers are not.
    """
    result = Table(box=box.SIMPLE_HEAD, pad_edge=False, header_style="bold")
    rows = [tuple(row) for row in rows]
    for column, heading in enumerate(headings):
        result.add_column(
            plain(heading.replace(" / ", "\n")),
            justify="left" if column < left else "right",
            overflow="fold",
            min_width=_longest_word([heading, *(row[column] for row in rows)]),
            no_wrap=column >= left and not any(_is_word(row[column]) for row in rows),
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
        if (minimum := _minimum(result)) > out.width:
            result.width = minimum
        out.print(result, crop=False)


def _fitting(
    headings: Sequence[str], rows: Sequence[Sequence[str]], left: int
) -> list[tuple[int, ...]]:
    """Return the columns of each table, as few tables as fit the width of the terminal."""
    every = tuple(range(len(headings)))
    repeated, parts = every[: max(left, 1)], list[tuple[int, ...]]()
    current = repeated
    for column in every[len(repeated) :]:
        wider = (*current, column)
        cells = [[row[each] for each in wider] for row in rows]
        found = table([headings[each] for each in wider], cells, left=left)
        if len(current) > len(repeated) and _minimum(found) > out.width:
            parts.append(current)
            wider = (*repeated, column)
        current = wider
    return [*parts, current]


def _minimum(result: Table) -> int:
    """Return the least width of a table."""
    return out.measure(result, options=out.options.update(width=10_000)).minimum


def _longest_word(texts: Sequence[str]) -> int:
    return min(24, max((len(word) for text in texts for word in text.split()), default=0))


def _is_word(cell: str) -> bool:
    try:
        float(cell.replace(",", ""))
    except ValueError:
        return any(sign.isalpha() for sign in cell)
    return False


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
