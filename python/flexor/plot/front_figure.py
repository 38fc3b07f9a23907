"""Figure of a front: the objectives against each other, and the parameters along the front."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.arrays import Array
from flexor.plot.style import EXOSUIT, LINE, PAGE, literal, style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexor.study import Front, Study

OTHERS = "#C9CED3"
# Of the parameters along the front, in Okabe and Ito's colours and three strokes.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
STROKES = ("-", "--", ":")
# Points with numbers in the figure: so many; the size of a panel and the room of a number [pt]; and
# where a number may be seen from its point, the nearest places first [pt].
NUMBERS = 14
PANEL, ROOM = np.array([235.0, 180.0]), np.array([8.0, 7.0])
PLACES = [
    (round(r * np.cos(a), 3), round(r * np.sin(a), 3))
    for r in (9.0, 14.0, 20.0, 28.0)
    for a in np.pi * np.array([0.25, 0.75, 1.25, 1.75, 0.5, 1.5, 0.0, 1.0])
]
# Share of the front's range that is shown of other designs beyond its ends.
AROUND = 0.25


def front(study: Study) -> Figure:
    """Plot the front of a study with several objectives.

    Parameters
    ----------
    study : Study
        Result of `flexor.optimize` with several objectives.

    Returns
    -------
    matplotlib.figure.Figure
        One page wide. A panel for each pair of objectives has the front, with the numbers of some
        points, other feasible designs that were evaluated, and the start; the last panel has the
        parameters along the front, as fractions of their ranges.
    """
    from matplotlib.figure import Figure

    found = study.front
    pairs = list(combinations(range(len(found.objectives)), 2))[:5] or [(0, 0)]
    count = len(pairs) + 1
    columns = min(count, 3) if count > 2 else 2
    rows = -(-count // columns)
    with style():
        figure = Figure(figsize=(PAGE, (0.52 if count <= 2 else 0.38 * rows + 0.1) * PAGE))
        figure.set_layout_engine("constrained")
        others = _others(study, found)
        for place, (across, up) in enumerate(pairs, start=1):
            axes = figure.add_subplot(rows, columns, place)
            _objectives(axes, found, others, across, up)
        _parameters(figure.add_subplot(rows, columns, count), found)
        if len(pairs) >= 1:
            handles = figure.axes[0].get_legend_handles_labels()
            figure.legend(*handles, loc="outside lower left", ncols=3)
    return figure


def _others(study: Study, found: Front) -> dict[str, Array]:
    """Return the objectives of all feasible designs, and of the start, in display units."""
    outcomes = study.record.outcomes()
    good = np.isfinite(outcomes.value) & (outcomes.violation == 0.0)
    every = outcomes.objective_values[good] if found.problem.objective.count else None
    values = outcomes.value[good][:, None] if every is None else every
    start = study.record.outcomes(study.start.vector)
    first = np.zeros((0, values.shape[1]))
    if len(start) and found.problem.objective.count:
        first = start.objective_values
    return {"evaluated": _shown(found, values), "start": _shown(found, first)}


def _shown(found: Front, values: Array) -> Array:
    columns = [
        each.displayed(column) for each, column in zip(found.objectives, values.T, strict=True)
    ]
    return np.stack(columns, axis=1)


def _objectives(axes: Any, found: Front, others: dict[str, Array], across: int, up: int) -> None:
    x, y = found.shown[:, across], found.shown[:, up]
    evaluated, start = others["evaluated"], others["start"]
    axes.plot(
        evaluated[:, across], evaluated[:, up], ".", color=OTHERS, markersize=2.0,
        rasterized=True, zorder=1, label="other feasible designs",
    )  # fmt: skip
    stroke = "-" if len(found.objectives) == 2 else ""
    axes.plot(
        x, y, linestyle=stroke, marker="o", color=EXOSUIT, markersize=3.0, linewidth=0.8,
        markeredgecolor=LINE, markeredgewidth=0.4, zorder=3, label="front",
    )  # fmt: skip
    for set_limits, values in ((axes.set_xlim, x), (axes.set_ylim, y)):
        around = AROUND * (np.ptp(values) or abs(values[0]) or 1.0)
        set_limits(values.min() - around, values.max() + around)
    low, high = axes.get_xlim()
    bottom, top = axes.get_ylim()
    inside = [low <= a <= high and bottom <= b <= top for a, b in start[:, [across, up]]]
    if any(inside):
        axes.plot(
            start[:, across], start[:, up], "D", color="white", markeredgecolor=LINE,
            markersize=5.0, zorder=4, label="start",
        )  # fmt: skip
    _number(axes, found, x, y)
    axes.set_xlabel(literal(_better(found, across)))
    axes.set_ylabel(literal(_better(found, up)))


def _number(axes: Any, found: Front, x: Array, y: Array) -> None:
    """Write the numbers of points beside them, a line leading to each, where there is room."""
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    at = np.stack([(x - left) / (right - left), (y - bottom) / (top - bottom)], axis=1)
    taken: list[Array] = []
    for row in found.spread(NUMBERS):
        for dx, dy in PLACES:
            place = at[row] + np.array([dx, dy]) / PANEL
            near = np.abs(np.concatenate([at, *taken]) - place) < ROOM / PANEL
            if not near.all(axis=1).any():
                break
        else:
            continue
        taken.append(place[None])
        axes.annotate(
            str(row + 1), (x[row], y[row]), xytext=(dx, dy), textcoords="offset points",
            ha="center", va="center", fontsize=6.5, zorder=5,
            arrowprops={"arrowstyle": "-", "linewidth": 0.4, "shrinkA": 3.0, "shrinkB": 1.5},
        )  # fmt: skip


def _better(found: Front, index: int) -> str:
    """Return the heading of an objective with an arrow to where it is better."""
    sign = getattr(found.objectives[index], "sign", 1.0)
    return f"{found.headings[index]} ({'more' if sign < 0.0 else 'less'} is better)"


def _parameters(axes: Any, found: Front) -> None:
    chosen = found.problem.parameters
    share = (found.designs - chosen.lower) / (chosen.upper - chosen.lower)
    x = found.shown[:, 0]
    for index, label in enumerate(chosen.labels):
        colour = COLOURS[index % len(COLOURS)]
        stroke = STROKES[(index // len(COLOURS)) % len(STROKES)]
        axes.plot(
            x, share[:, index], stroke, color=colour, marker=".", markersize=2.5, linewidth=0.8,
            label=literal(label),
        )  # fmt: skip
    axes.set_ylim(-0.03, 1.03)
    axes.set_xlabel(literal(found.headings[0]))
    axes.set_ylabel("parameter, share of its range")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, fontsize=6.5)
