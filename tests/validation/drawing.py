"""What the figures of the report have in common."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
# Okabe and Ito's colours, for series without an order.
SERIES = ("#0072B2", "#E69F00", "#009E73", "#D55E00")
MARKS = ("o-", "s-", "^-", "v--")


def dots(axes: Axes, x: ArrayLike, y: ArrayLike) -> None:
    """Draw Flexor's values on top of the lines of a reference."""
    axes.plot(x, y, "k.", markersize=3.0, zorder=3)


def refinement(axes: Axes, counts: Sequence[int], errors: dict[str, Array]) -> None:
    """Draw errors over a number that doubles, in logarithmic scales."""
    for (label, values), colour, mark in zip(errors.items(), SERIES, MARKS, strict=False):
        axes.loglog(counts, values, mark, markersize=4.0, color=colour, label=label)
    axes.set_xticks(counts, [str(count) for count in counts])
    axes.minorticks_off()
    axes.set_xlabel("elements")


def order(axes: Axes, counts: Sequence[int], error: float, slope: int, *, above: bool) -> None:
    """Draw a line that falls at an order, from an error at the first count on."""
    sizes = np.array(counts, dtype=float)
    line = error * (sizes[0] / sizes) ** slope
    axes.plot(sizes, line, "--", color="0.55", linewidth=0.8)
    axes.annotate(
        f"order {slope}",
        (sizes[1], line[1]),
        xytext=(2.0, 1.0) if above else (-2.0, -1.0),
        textcoords="offset points",
        color="0.35",
        fontsize=7.0,
        ha="left" if above else "right",
        va="bottom" if above else "top",
    )
