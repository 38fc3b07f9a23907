"""Tables in the terminal, in one look."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rich import box
from rich.table import Table

from flexor.cli.console import out


def table(headings: Sequence[str], rows: Iterable[Sequence[str]], *, left: int = 1) -> Table:
    """Make a table.

    Parameters
    ----------
    headings : sequence of str
        One for each column; a unit after " / " goes onto a line of its own.
    rows : iterable of sequences of str
        The cells.
    left : int
        So many columns hold words and are aligned to the left. Where the terminal is narrow,
        columns of words are folded; numbers are not.

    Returns
    -------
    rich.table.Table
        Ready to print.
    """
    made = Table(box=box.SIMPLE_HEAD, pad_edge=False, header_style="bold")
    rows = [tuple(row) for row in rows]
    for column, heading in enumerate(headings):
        made.add_column(
            heading.replace(" / ", "\n"),
            justify="left" if column < left else "right",
            overflow="fold",
            no_wrap=column >= left and not any(_is_word(row[column]) for row in rows),
        )
    for row in rows:
        made.add_row(*row)
    return made


def show(headings: Sequence[str], rows: Iterable[Sequence[str]], *, left: int = 1) -> None:
    """Print a table to stdout; see `table`.

    Where not even the numbers fit, lines go on beyond the terminal's width: no digit is lost.
    """
    made = table(headings, rows, left=left)
    least = out.measure(made, options=out.options.update(width=10_000)).minimum
    if least > out.width:
        made.width = least
    out.print(made, crop=False)


def _is_word(cell: str) -> bool:
    try:
        float(cell.replace(",", ""))
    except ValueError:
        return any(sign.isalpha() for sign in cell)
    return False


def fixed(value: float, decimals: int = 2) -> str:
    """Return a number with so many decimals, without -0.

    Parameters
    ----------
    value : float
        What to show.
    decimals : int
        Digits behind the point.
    """
    text = f"{value:.{decimals}f}"
    return text.removeprefix("-") if float(text) == 0.0 else text


def number(value: float, digits: int = 4) -> str:
    """Return a number with so many significant digits, without trailing zeros or -0.

    Parameters
    ----------
    value : float
        What to show.
    digits : int
        Significant digits.
    """
    text = f"{value:.{digits}g}"
    return "0" if float(text) == 0.0 else text
