"""Tables in the terminal, in one look."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rich import box
from rich.table import Table


def table(headings: Sequence[str], rows: Iterable[Sequence[str]], *, left: int = 1) -> Table:
    """Make a table.

    Parameters
    ----------
    headings : sequence of str
        One for each column; a unit after " / " goes onto a line of its own.
    rows : iterable of sequences of str
        The cells.
    left : int
        So many columns hold words and are aligned to the left; the others hold numbers.

    Returns
    -------
    rich.table.Table
        Ready to print.
    """
    made = Table(box=box.SIMPLE_HEAD, pad_edge=False, header_style="bold")
    for column, heading in enumerate(headings):
        made.add_column(
            heading.replace(" / ", "\n"),
            justify="left" if column < left else "right",
            overflow="fold",
            no_wrap=column >= left,
        )
    for row in rows:
        made.add_row(*row)
    return made


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
