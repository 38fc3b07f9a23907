"""Legends beside all axes of a figure, in as many columns as fit."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

# Characters of a line.
LONGEST = 80


def fitting_legend(
    figure: Figure, handles: Sequence[Artist], loc: Any, most: int, **options: Any
) -> None:
    """Draw a legend in at most so many columns, fewer where it would be wider than the figure.

    Parameters
    ----------
    figure
        The figure, with its width.
    handles
        What is shown; long labels are wrapped.
    loc, **options
        As of `matplotlib.figure.Figure.legend`.
    most
        Columns.
    """
    for handle in handles:
        handle.set_label(fill(str(handle.get_label()), LONGEST))
    for columns in range(most, 0, -1):
        legend = figure.legend(handles=list(handles), loc=loc, ncols=columns, **options)
        if columns == 1 or legend.get_window_extent().width <= figure.bbox.width:
            return
        legend.remove()
