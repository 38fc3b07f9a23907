"""Figure of the scaling benchmark."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.plot.style import CHAMBER, EXOSUIT, FORCE, LINE, PAGE, style

if TYPE_CHECKING:
    from _growth import Growth
    from matplotlib.figure import Figure

GUIDE: dict[str, Any] = {"color": "#9AA3A9", "linewidth": 0.8, "linestyle": (0, (4, 2))}


def draw(
    dof: Sequence[Growth], pairs: Growth, time: Growth, memory: Growth, speed: Growth
) -> Figure:
    """Draw all measurements, one page wide."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator

    with style():
        figure = Figure(figsize=(PAGE, 0.62 * PAGE), layout="constrained")
        (a, b, c), (d, e, f) = figure.subplots(2, 3)
        for growth, colour, marker in zip(dof, (EXOSUIT, FORCE), "os", strict=True):
            line = {"color": colour, "marker": marker, "markersize": 3.0, "label": growth.name}
            a.loglog(growth.sizes, 1e3 * np.array(growth.costs), **line)
            b.loglog(growth.sizes, 1e3 * np.array(growth.costs) * growth.extra, **line)
        for axes in (a, b):
            _set_limits(axes)
            _guide(axes, 0, "~ n")
            axes.set_xlabel("degrees of freedom n")
            axes.legend(loc="upper left")
        a.set(ylabel="time of an iteration / ms")
        b.set(ylabel="time of a design, 0 to 5 N / ms")
        c.loglog(pairs.sizes, 1e6 * np.array(pairs.costs), **_line())
        c.set(xlabel="pairs of spheres", ylabel="time of an iteration / µs")
        _set_limits(c)
        _guide(c, -1, "~ pairs")
        d.loglog(time.sizes, time.costs, **_line())
        d.set(xlabel="designs, one load step each", ylabel="time / s")
        _set_limits(d)
        _guide(d, -1, "~ designs")
        e.loglog(memory.sizes, memory.costs, **_line())
        e.set(xlabel="designs, one load step each", ylabel="peak memory / MB")
        _set_limits(e)
        f.plot(speed.sizes, speed.costs, **_line())
        f.plot(speed.sizes, [speed.costs[0] * n for n in speed.sizes], **GUIDE)
        f.set(xlabel="threads", ylabel="designs / s", xticks=speed.sizes)
        f.set_ylim(bottom=0.0)
        f.set_xlim(speed.sizes[0] - 0.3, speed.sizes[-1] + 0.3)
        for axes in (a, b, c, d, e, f):
            axes.grid(True)
        for axes in (a, b, c, d, e):
            axes.xaxis.set_major_locator(LogLocator(numticks=8))
            axes.minorticks_off()
    return figure


def _line() -> dict[str, Any]:
    return {"color": CHAMBER, "marker": "o", "markersize": 3.0}


def _set_limits(axes: Any) -> None:
    """Set limits with a margin around the curves, down to a power of ten."""
    (left, right), (bottom, top) = axes.dataLim.intervalx, axes.dataLim.intervaly
    axes.set_xlim(0.7 * left, 1.5 * right)
    axes.set_ylim(0.8 * 10.0 ** np.floor(np.log10(bottom)), 3.0 * top)


def _guide(axes: Any, through: int, label: str) -> None:
    """Draw a guide line of slope one below a point of the first curve."""
    curve = axes.get_lines()[0]
    x, y = np.asarray(curve.get_xdata(), float), np.asarray(curve.get_ydata(), float)
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    at = np.geomspace(left, right, 400)
    values = 0.4 * y[through] * (at / x[through])
    inside = (values > bottom) & (values < top) & (at < 1.4 * x[-1])
    axes.plot(at[inside], values[inside], **GUIDE)
    visible = np.flatnonzero(inside)
    position = visible[int(0.65 * len(visible))]  # clear of other lines
    axes.annotate(
        label, (at[position], values[position]), color=LINE, fontsize=7.0, ha="left", va="top",
        xytext=(3, -1), textcoords="offset points",
    )  # fmt: skip
