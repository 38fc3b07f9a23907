"""The figure of growth."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.plot.style import CHAMBER, EXOSUIT, FORCE, LINE, PAGE, style

if TYPE_CHECKING:
    from growth import Growth
    from matplotlib.figure import Figure

GUIDE: dict[str, Any] = {"color": "#9AA3A9", "linewidth": 0.8, "linestyle": (0, (4, 2))}


def draw(
    dof: Sequence[Growth], pairs: Growth, time: Growth, memory: Growth, speed: Growth
) -> Figure:
    """Draw everything, as wide as a page."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=(PAGE, 0.62 * PAGE), layout="constrained")
        (a, b, c), (d, e, f) = figure.subplots(2, 3)
        for growth, colour, marker in zip(dof, (EXOSUIT, FORCE), "os", strict=True):
            line = {"color": colour, "marker": marker, "markersize": 3.0, "label": growth.name}
            a.loglog(growth.sizes, 1e3 * np.array(growth.costs), **line)
            b.loglog(growth.sizes, 1e3 * np.array(growth.costs) * growth.also, **line)
        for axes in (a, b):
            _guide(axes, 1, "~ n"), _guide(axes, 3, "~ n³")
            axes.set_xlabel("degrees of freedom n")
            axes.legend(loc="upper left")
        a.set(ylabel="time of an iteration / ms")
        b.set(ylabel="time of a design, 0 to 5 N / ms")
        c.loglog(pairs.sizes, 1e6 * np.array(pairs.costs), **_line())
        c.set(xlabel="contact pairs tested", ylabel="time of an iteration / µs")
        _guide(c, 1, "~ pairs")
        d.loglog(time.sizes, time.costs, **_line())
        d.set(xlabel="designs, one load step each", ylabel="time / s")
        _guide(d, 1, "~ designs")
        e.loglog(memory.sizes, memory.costs, **_line())
        e.set(xlabel="designs, one load step each", ylabel="peak memory / MB")
        f.plot(speed.sizes, speed.costs, **_line())
        f.plot(speed.sizes, [speed.costs[0] * n for n in speed.sizes], **GUIDE)
        f.set(xlabel="threads", ylabel="designs / s", xticks=speed.sizes)
        f.set_ylim(bottom=0.0)
        f.set_xlim(speed.sizes[0] - 0.3, speed.sizes[-1] + 0.3)
        for axes in (a, b, c, d, e, f):
            axes.grid(True)
            axes.minorticks_off()
    return figure


def _line() -> dict[str, Any]:
    return {"color": CHAMBER, "marker": "o", "markersize": 3.0}


def _guide(axes: Any, power: int, label: str) -> None:
    """Draw a line of slope `power` through the last point, over the last decade or so."""
    last = axes.get_lines()[0]
    x, y = np.asarray(last.get_xdata(), float), np.asarray(last.get_ydata(), float)
    ends = np.array([x[-1] / (30.0 if power == 1 else 6.0), x[-1]])
    values = 0.6 * y[-1] * (ends / x[-1]) ** power
    limits = axes.get_xlim(), axes.get_ylim()
    axes.plot(ends, values, **GUIDE)
    axes.annotate(
        label, (ends[0], values[0]), color=LINE, fontsize=7.0, ha="right", va="center",
        xytext=(-2, 0), textcoords="offset points",
    )  # fmt: skip
    axes.set(xlim=limits[0], ylim=limits[1])
