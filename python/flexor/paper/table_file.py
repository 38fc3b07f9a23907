"""Tables as CSV."""

from __future__ import annotations

import csv
import io
import math

from flexor.paper.section import Cell, Table


def as_csv(table: Table) -> str:
    """Return a table as CSV, with every digit of its numbers.

    Parameters
    ----------
    table : Table
        What to write.

    Returns
    -------
    str
        One heading line with units, one line for each row; what is missing is empty.
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([f"{c.heading} [{c.unit}]" if c.unit else c.heading for c in table.columns])
    writer.writerows([_plain(cell) for cell in row] for row in table.rows)
    return out.getvalue()


def _plain(cell: Cell) -> str | int | float:
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return ""
    if isinstance(cell, bool):
        return "yes" if cell else "no"
    return cell
