"""The figure of a calibration: how the targets are met, and profiles of the constants."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from flexor.calibration.identifiability import THRESHOLD
from flexor.calibration.report import Row, rows
from flexor.calibration.result import Calibration
from flexor.plot.style import CHAMBER, FORCE, LINE, PAGE, literal, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MET, _MISSED, _PREDICTED = FORCE, CHAMBER, "#8A939B"
_MAX_TARGET_ROWS = 24


def draw(calibration: Calibration) -> Figure:
    """Draw a calibration, as wide as a page.

    Left, the deviation of each target in tolerances; right, the profile likelihood of each
    constant, and how well combinations of them are identified.
    """
    from matplotlib.figure import Figure

    shown = [row for row in rows(calibration.best) if math.isfinite(row.found)]
    found = calibration.identifiability
    count = len(found.constants)
    height = max(
        2.6, 0.75 + 0.2 * min(len(shown), _MAX_TARGET_ROWS), 1.15 * math.ceil(count / 2) + 1.2
    )
    with style():
        figure = Figure(figsize=(PAGE, height), layout="constrained")
        left, right = np.ravel(np.asarray(figure.subfigures(1, 2, width_ratios=(1.0, 1.05))))
        _targets(left.subplots(), shown)
        columns = min(count, 2)
        lines = math.ceil(count / columns)
        grid = right.add_gridspec(lines + 1, columns, height_ratios=[*[1.0] * lines, 0.9])
        for i in range(count):
            _profile(right.add_subplot(grid[i // columns, i % columns]), calibration, i)
        _combinations(right.add_subplot(grid[lines, :]), calibration)
    return figure


def _targets(axes: Axes, shown: list[Row]) -> None:
    shown = shown[:_MAX_TARGET_ROWS]
    for place, row in enumerate(shown):
        size = row.tolerance if math.isfinite(row.tolerance) else 0.05 * abs(row.wanted) or 1.0
        off = row.off / size
        inside = abs(off) <= 1.0 or row.weight == "soft"
        colour = _PREDICTED if row.weight == "held-out" else _MET if inside else _MISSED
        clipped = max(-9.5, min(9.5, off))
        marker = "o" if clipped == off else (">" if off > 0 else "<")
        axes.plot([0.0, clipped], [place, place], color=colour, linewidth=0.8)
        axes.plot(clipped, place, marker, color=colour, markersize=4)
        text = f"{row.found:.3g} ({row.wanted:.3g}) {literal(row.unit)}".rstrip()
        axes.annotate(
            text, (1.02, place), xycoords=("axes fraction", "data"), va="center", fontsize=6.5
        )
    axes.axvspan(-1.0, 1.0, color="#E3E8EC", zorder=0, linewidth=0)
    axes.axvline(0.0, color=LINE, linewidth=0.6)
    axes.set_yticks(range(len(shown)), [_label(row) for row in shown], fontsize=6.5)
    axes.set_ylim(len(shown) - 0.4, -0.6)
    widest = max([1.5, *(abs(x) for line in axes.lines[::2] for x in np.asarray(line.get_xdata()))])
    axes.set_xlim(-1.1 * widest, 1.1 * widest)
    axes.set_xlabel("off, in tolerances (held out: in 5 % of the value)")
    axes.set_title("targets: found (wanted)", loc="left")


def _profile(axes: Axes, calibration: Calibration, i: int) -> None:
    found = calibration.identifiability
    constant, dots = found.constants[i], "o-"
    if found.profiles:
        u, rise = found.profiles[i].u, found.profiles[i].rise
    else:
        # Without profiles, the misfit of the linearised model.
        u, dots = np.clip(found.u[i] + found.deviation[i] * np.linspace(-3.5, 3.5, 29), 0, 1), "--"
        rise = ((u - found.u[i]) / found.deviation[i]) ** 2
    values = constant.value(u) / constant.unit.factor
    axes.plot(values, rise, dots, color=FORCE, markersize=2.5, linewidth=0.9)
    low, high = (end / constant.unit.factor for end in found.interval(i))
    axes.axvspan(low, high, color="#E3E8EC", zorder=0, linewidth=0)
    axes.axhline(THRESHOLD, color=LINE, linewidth=0.5, linestyle=":")
    axes.set_ylim(0.0, max(5.0, min(15.0, float(np.nanmax(rise)) * 1.05)))
    axes.set_xlabel(
        literal(f"{constant.name} / {constant.unit.text}".removesuffix(" / ")), labelpad=1
    )
    axes.locator_params(axis="x", nbins=3)
    if i % 2 == 0:
        axes.set_ylabel("misfit rises by", labelpad=2)
    if i == 0:
        axes.set_title("constants", loc="left")


def _combinations(axes: Axes, calibration: Calibration) -> None:
    found = calibration.identifiability
    spread = [direction.deviation for direction in found.directions]
    for place, direction in enumerate(found.directions):
        axes.barh(place, direction.deviation, color=FORCE, height=0.22)
        axes.annotate(
            literal(found.describe(direction)),
            (0.0, place - 0.34),
            xycoords=("axes fraction", "data"),
            fontsize=6.5,
            va="center",
        )
    axes.set_xscale("log")
    axes.set_xlim(min(1e-4, 0.5 * min(spread)), 1.0)
    axes.set_ylim(len(spread) - 0.5, -0.7)
    axes.set_yticks([])
    axes.set_title("combinations, the best identified first", loc="left")
    axes.spines["left"].set_visible(False)
    axes.set_xlabel("standard deviation, in parts of the ranges", labelpad=1)


def _label(row: Row) -> str:
    target = literal(row.target)
    return target if row.force is None else f"{target}, {row.force:g} N"
