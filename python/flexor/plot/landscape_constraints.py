"""Constraints in the figure of a landscape: what is infeasible, and where each is active."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.plot.style import literal

if TYPE_CHECKING:
    from flexor.study.landscape import Landscape

# Of the lines on which constraints are active, on viridis and on white.
_STYLES = (
    *(("#D55E00", "-"), ("#CC79A7", "-"), ("#E69F00", "-"), ("#000000", "-")),
    *(("#D55E00", "--"), ("#CC79A7", "--"), ("#E69F00", "--"), ("#000000", "--")),
)
# How much white is mixed into the colours of infeasible designs.
_FADED = 0.55
_HATCH = "////"
_HATCHED: dict[str, Any] = {"facecolor": "#F2F3F4", "edgecolor": "#9AA0A6", "linewidth": 0.0}


def active(landscape: Landscape) -> list[tuple[int, str, tuple[str, str]]]:
    """Return each constraint that is kept in one part of a landscape and exceeded in another.

    Its index, its text, and colour and style of its line.
    """
    found: list[tuple[int, str, tuple[str, str]]] = []
    for index, text in enumerate(landscape.constraints):
        excess = landscape.excesses[..., index]
        if np.any(excess > 0.0) and np.any(excess <= 0.0):
            found.append((index, text, _STYLES[len(found) % len(_STYLES)]))
    return found


def draw_plan(plan: Any, x: Array, y: Array, landscape: Landscape) -> None:
    """Hatch the infeasible part of a contour plot and outline it constraint by constraint."""
    infeasible = landscape.infeasible
    if not infeasible.any():
        return
    worst = np.where(landscape.failed, np.nan, np.nan_to_num(landscape.excesses, nan=-1.0).max(-1))
    shade: Any = {"colors": ["white"], "alpha": _FADED, "zorder": 2.0}
    levels = [0.0, max(float(np.nanmax(worst)), 1e-12) * 1.01]
    plan.contourf(x, y, np.ma.masked_invalid(worst.T), levels, **shade)
    hatched = plan.contourf(
        x, y, np.ma.masked_invalid(worst.T), levels, colors="none", hatches=[_HATCH], zorder=2.1
    )
    hatched.set_edgecolor(_HATCHED["edgecolor"])
    hatched.set_linewidth(0.0)
    for index, _, (colour, stroke) in active(landscape):
        excess = np.ma.masked_invalid(landscape.excesses[..., index].T)
        plan.contour(
            x, y, excess, [0.0], colors=[colour], linestyles=[stroke], linewidths=1.4, zorder=2.5
        )


def faded(colours: Array, infeasible: NDArray[np.bool_]) -> Array:
    """Mix white into the colours (n, m, 4) of infeasible designs (n, m)."""
    result = colours.copy()
    result[infeasible, :3] = (1.0 - _FADED) * result[infeasible, :3] + _FADED
    return result


def draw_curve(axes: Any, x: Array, landscape: Landscape) -> None:
    """Hatch where a curve is infeasible and mark where each constraint becomes active."""
    half = 0.5 * (x[1] - x[0])
    for at in x[landscape.infeasible]:
        axes.axvspan(at - half, at + half, hatch=_HATCH, zorder=0.5, **_HATCHED)
    for index, _, (colour, stroke) in active(landscape):
        excess = landscape.excesses[:, index]
        for first in np.flatnonzero((excess[:-1] > 0.0) != (excess[1:] > 0.0)):
            low, high = excess[first], excess[first + 1]
            if np.isfinite([low, high]).all():
                at = x[first] + (x[first + 1] - x[first]) * low / (low - high)
                axes.axvline(at, color=colour, linestyle=stroke, linewidth=1.2, zorder=1.5)


def handles(landscape: Landscape) -> list[Any]:
    """Return the entries of the legend."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    found: list[Any] = []
    if landscape.infeasible.any():
        found.append(Patch(hatch=_HATCH, label="infeasible", **_HATCHED))
    for _, text, (colour, stroke) in active(landscape):
        shown = text.replace("<=", "≤").replace(">=", "≥")
        label = literal(f"{shown} is active")
        line: dict[str, Any] = {"color": colour, "linestyle": stroke, "linewidth": 1.4}
        found.append(Line2D([], [], label=label, **line))
    return found
