"""Figure of a landscape: surface and contour plot, or a curve over one parameter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.arrays import Array
from flexor.objectives import Extremum
from flexor.optimizers import entries
from flexor.plot.landscape_constraints import draw_curve, draw_plan, faded
from flexor.plot.landscape_constraints import handles as constraint_handles
from flexor.plot.style import COLUMN, LINE, PAGE, literal, style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexor.study.landscape import Landscape, SearchPath


# Marks of the minimum, of designs that snap and of those that failed.
STAR: dict[str, Any] = {
    "marker": "*",
    "color": "#D55E00",
    "markeredgecolor": "white",
    "linestyle": "",
}
SNAP = "#000000"
FAILED = "#C9CED3"
# Colour and marker of the search paths of each method.
PATH_STYLES = (("#FFFFFF", "o"), ("#56B4E9", "s"), ("#F0E442", "^"), ("#CC79A7", "D"))
SYMBOLS = {
    "bending": "$f_b$",
    "tip-force": "$f_{exo}$",
    "bending-contact": "$f_{bc}$",
    "bending-contact-printed": "$f_{bc}$ as printed",
}
CONTOUR_LEVELS = 12
ELEVATION, AZIMUTH = 40.0, 12.0  # degrees


def landscape(landscape: Landscape, paths: Sequence[SearchPath] = ()) -> Figure:
    """Plot an objective over one or two parameters.

    Parameters
    ----------
    landscape : Landscape
        Result of `flexor.landscape`.
    paths : sequence of SearchPath
        Searches of the same parameter set to overlay.

    Returns
    -------
    matplotlib.figure.Figure
        A surface and a contour plot, one page wide; or a curve, one column wide. The best design,
        the designs that snap or bifurcate, those that failed, those that are infeasible and the
        lines on which constraints are active are marked.
    """
    from matplotlib.figure import Figure

    with style():
        if len(landscape.axes) == 1:
            figure = Figure(figsize=(COLUMN, 0.85 * COLUMN), layout="constrained")
            _curve(figure, landscape, paths)
        else:
            figure = Figure(figsize=(PAGE, 0.54 * PAGE))
            _views(figure, landscape, paths)
    return figure


def _views(figure: Figure, landscape: Landscape, paths: Sequence[SearchPath]) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    x, y = _display_axes(landscape)
    value = _values(landscape).T  # rows are the second parameter
    low, high = (np.nanmin(value), np.nanmax(value)) if np.isfinite(value).any() else (0.0, 1.0)
    colours = ScalarMappable(Normalize(low, high if high > low else low + 1.0), "viridis")
    space: Any = figure.add_axes((-0.005, 0.15, 0.45, 0.83), projection="3d", computed_zorder=False)
    plan = figure.add_axes((0.6, 0.24, 0.31, 0.73))
    _surface(space, x, y, value, colours, landscape)
    _plan(plan, x, y, value, colours, landscape)
    for axes in (space, plan):
        axes.set_xlabel(_label(landscape, 0))
        axes.set_ylabel(_label(landscape, 1))
    space.set_zlabel(_value_label(landscape))
    for path_style, path in _with_styles(paths):
        _draw_search(space, plan, landscape, path, path_style)
    if not landscape.failed.all():
        i, j = landscape.minimum_index
        _set_view(space, x, y, (i, j), _maximised(landscape))
        plan.plot(x[i], y[j], markersize=14, markeredgewidth=0.8, zorder=6.5, clip_on=False, **STAR)
        space.plot([x[i]], [y[j]], [value[j, i]], markersize=12, zorder=9, **STAR)
    place = plan.get_position(original=False)
    bar_axes = figure.add_axes((0.915, place.y0, 0.015, place.height))
    bar: Any = figure.colorbar(colours, cax=bar_axes)
    bar.set_label(_value_label(landscape))
    bar.outline.set_linewidth(0.6)
    figure.legend(handles=_handles(landscape, paths), loc="lower center", ncols=3)


def _surface(
    space: Any, x: Array, y: Array, value: Array, colours: Any, landscape: Landscape
) -> None:
    from matplotlib.ticker import MaxNLocator

    X, Y = np.meshgrid(x, y)
    space.plot_surface(
        X,
        Y,
        value,
        facecolors=faded(colours.to_rgba(_faces(value)), landscape.infeasible.T),
        rcount=value.shape[0],
        ccount=value.shape[1],
        linewidth=0.0,
        antialiased=False,
        shade=True,
        rasterized=True,
        zorder=1,
    )
    space.set_xlim(x[0], x[-1])
    space.set_ylim(y[0], y[-1])
    space.set_box_aspect((1.0, 1.0, 0.7), zoom=0.86)
    for axis in (space.xaxis, space.yaxis, space.zaxis):
        axis.pane.set_facecolor("white")
        axis.pane.set_edgecolor("#D5DADE")
        axis._axinfo["grid"].update(color="#E3E6E9", linewidth=0.4)
        axis.set_tick_params(pad=-2)
        # Omit the end ticks, which would overlap where two axes meet.
        axis.set_major_locator(MaxNLocator(4, prune=None if axis is space.zaxis else "both"))
        axis.labelpad = -4.0
    space.zaxis.labelpad = -1.0


def _set_view(space: Any, x: Array, y: Array, index: tuple[int, int], highest: bool) -> None:
    """Turn the corner nearest to a minimum to the front, or to a maximum to the back.

    It is visible there, and the surface rises away from the eye rather than being seen edge-on.
    """
    near = -1.0 if highest else 1.0
    sides = [
        near if i > 0.5 * (len(axis) - 1) else -near for i, axis in zip(index, (x, y), strict=True)
    ]
    # Off the diagonal, so that the two horizontal axes are distinguishable.
    space.view_init(ELEVATION, np.degrees(np.arctan2(sides[1], sides[0])) + AZIMUTH)


def _faces(value: Array) -> Array:
    """Return the mean value of the corners of each face, for its colour."""
    faces = value.copy()
    faces[:-1, :-1] = 0.25 * (value[:-1, :-1] + value[1:, :-1] + value[:-1, 1:] + value[1:, 1:])
    return faces


def _plan(plan: Any, x: Array, y: Array, value: Array, colours: Any, landscape: Landscape) -> None:
    plan.set_facecolor(FAILED)
    plan.pcolormesh(
        x, y, value, cmap=colours.cmap, norm=colours.norm, shading="nearest", rasterized=True
    )
    if np.nanmax(value, initial=-np.inf) > np.nanmin(value, initial=np.inf):
        plan.contour(
            x,
            y,
            np.ma.masked_invalid(value),
            CONTOUR_LEVELS,
            colors="white",
            linewidths=0.4,
            alpha=0.6,
        )
    draw_plan(plan, x, y, landscape)
    across, up = np.nonzero((landscape.events > 0) & ~landscape.failed)
    size = (min(PAGE * 72.0 * 0.38 / max(x.size, y.size), 8.0) * 0.45) ** 2
    plan.scatter(x[across], y[up], s=size, c=SNAP, linewidths=0.0, zorder=3, rasterized=True)
    plan.set_xlim(x[0], x[-1])
    plan.set_ylim(y[0], y[-1])
    ranges = np.ptp(x), np.ptp(y)
    units = {unit for _, _, _, unit in _varied(landscape)}
    if len(units) == 1 and 0.5 <= ranges[0] / ranges[1] <= 2.0:
        plan.set_aspect("equal")
    plan.spines[["top", "right"]].set_visible(True)


def _draw_search(
    space: Any, plan: Any, landscape: Landscape, path: SearchPath, path_style: tuple[str, str]
) -> None:
    from matplotlib.patheffects import withStroke

    if len(path.values) == 0:
        return
    colour, marker = path_style
    x, y = (_column(landscape, path, axis) for axis in (0, 1))
    plan.plot(x, y, color=colour, linewidth=0.9, zorder=5)
    plan.plot(x, y, color=LINE, linewidth=1.8, zorder=4)
    # Searches often end on a bound, where markers must not be clipped.
    ends: dict[str, Any] = {"markeredgewidth": 0.7, "linestyle": "", "clip_on": False}
    plan.plot(
        x[0], y[0], marker=marker, color=colour, markersize=3.5, zorder=6, markeredgecolor=LINE,
        **ends,
    )  # fmt: skip
    ends["markeredgecolor"] = "white"
    # Later methods get smaller markers on top, so that coincident ends remain visible.
    order = 0.1 * [each for _, each in PATH_STYLES].index(marker)
    plan.plot(
        x[-1], y[-1], marker=marker, color=LINE, markersize=5.5 - 18.0 * order, zorder=7.0 + order,
        **ends,
    )  # fmt: skip
    if path.label:
        plan.annotate(
            literal(path.label),
            (x[0], y[0]),
            xytext=(3, 3 if marker == PATH_STYLES[0][1] else -8),
            textcoords="offset points",
            fontsize=6.5,
            color="white",
            zorder=8,
            annotation_clip=True,
            path_effects=[withStroke(linewidth=1.4, foreground=LINE)],
        )
    heights = landscape.problem.objective.displayed(path.values)
    space.plot(x, y, heights, color=LINE, linewidth=1.6, zorder=4)
    space.plot(x, y, heights, color=colour, linewidth=0.8, zorder=5)
    for i, face, size in ((0, colour, 3.0), (-1, LINE, 4.0)):
        space.plot(
            [x[i]], [y[i]], [heights[i]], marker=marker, color=face, markersize=size,
            zorder=6, **ends,
        )  # fmt: skip


def _curve(figure: Figure, landscape: Landscape, paths: Sequence[SearchPath]) -> None:
    axes = figure.add_subplot()
    (x,) = _display_axes(landscape)
    value = _values(landscape)
    draw_curve(axes, x, landscape)
    axes.plot(x, value, color="#0072B2", zorder=2)
    snapped = (landscape.events > 0) & ~landscape.failed
    axes.plot(x[snapped], value[snapped], ".", color=SNAP, markersize=3.0, zorder=3)
    half = 0.5 * (x[1] - x[0])
    for bad in x[landscape.failed]:
        axes.axvspan(bad - half, bad + half, color=FAILED, linewidth=0.0, zorder=1)
    for (colour, marker), path in _with_styles(paths):
        across, heights = (
            _column(landscape, path, 0),
            landscape.problem.objective.displayed(path.values),
        )
        axes.plot(across, heights, color=LINE, linewidth=0.6, zorder=4)
        ends: dict[str, Any] = {"marker": marker, "markeredgecolor": LINE, "linestyle": ""}
        axes.plot(across[:1], heights[:1], color=colour, markersize=4.0, zorder=5, **ends)
        axes.plot(across[-1:], heights[-1:], color=LINE, markersize=5.0, zorder=6, **ends)
    if not landscape.failed.all():
        (i,) = landscape.minimum_index
        axes.plot(x[i], value[i], markersize=11, zorder=7, **STAR)
    axes.set_xlim(x[0], x[-1])
    axes.set_xlabel(_label(landscape, 0))
    axes.set_ylabel(_value_label(landscape))
    figure.legend(handles=_handles(landscape, paths), loc="outside lower center", ncols=2)


def _handles(landscape: Landscape, paths: Sequence[SearchPath]) -> list[Any]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = []
    if not landscape.failed.all():
        best = landscape.minimum
        position = ", ".join(
            f"{_mathematical(landscape.labels[axis])} = {best.vector[column] / scale:.3g}"
            f"{'' if unit == '1' else ' ' + unit}"
            for axis, column, scale, unit in _varied(landscape)
        )
        word = "least violation" if not best.feasible else "minimum"
        word = "best" if best.feasible and _maximised(landscape) else word
        handles.append(Line2D([], [], markersize=11, label=f"{word} at {position}", **STAR))
    if np.any((landscape.events > 0) & ~landscape.failed):
        handles.append(
            Line2D([], [], marker=".", color=SNAP, linestyle="", label="snaps or bifurcations")
        )
    if landscape.failed.any():
        handles.append(Patch(facecolor=FAILED, label="failed"))
    handles += constraint_handles(landscape)
    styles = {path.method: path_style for path_style, path in _with_styles(paths)}
    for method, (colour, marker) in styles.items():
        name = entries()[method].title if method in entries() else method
        edge: dict[str, Any] = {"marker": marker, "markeredgecolor": LINE, "markersize": 4.5}
        handles.append(Line2D([], [], color=colour, label=f"{name}: start", linestyle="", **edge))
        handles.append(Line2D([], [], color=LINE, label=f"{name}: end", linestyle="", **edge))
    return handles


def _with_styles(paths: Sequence[SearchPath]) -> list[tuple[tuple[str, str], SearchPath]]:
    methods = list(dict.fromkeys(path.method for path in paths))
    return [(PATH_STYLES[methods.index(path.method) % len(PATH_STYLES)], path) for path in paths]


def _varied(landscape: Landscape) -> list[tuple[int, int, float, str]]:
    """Return each axis with its column, the SI value of its unit, and the unit."""
    chosen = landscape.problem.parameters
    return [
        (axis, column, float(chosen.scale[column]), chosen.units[column])
        for axis, column in enumerate(landscape.columns)
    ]


def _display_axes(landscape: Landscape) -> list[Array]:
    return [landscape.axes[axis] / scale for axis, _, scale, _ in _varied(landscape)]


def _column(landscape: Landscape, path: SearchPath, axis: int) -> Array:
    _, column, scale, _ = _varied(landscape)[axis]
    return np.asarray(path.designs[:, column] / scale)


def _label(landscape: Landscape, axis: int) -> str:
    _, _, _, unit = _varied(landscape)[axis]
    name = _mathematical(landscape.labels[axis])
    return name if unit == "1" else f"{name} / {unit}"


def _mathematical(label: str) -> str:
    if "." in label:  # a field of the model file
        return literal(label)
    stem, _, index = label.partition("_")
    stem = "\\phi" if stem == "phi" else stem
    return f"${stem}_{{{index}}}$" if index else f"${stem}$"


def _maximised(landscape: Landscape) -> bool:
    objective = landscape.problem.objective
    return isinstance(objective, Extremum) and objective.sign < 0.0


def _values(landscape: Landscape) -> Array:
    """Return what is drawn, NaN where a design failed."""
    value = np.where(landscape.failed, np.nan, landscape.value)
    return landscape.problem.objective.displayed(value)


def _value_label(landscape: Landscape) -> str:
    objective = landscape.problem.objective
    if isinstance(objective, Extremum):
        return literal(f"{objective.quantity} / {objective.unit}".removesuffix(" / "))
    name = SYMBOLS.get(objective.name, objective.name)
    # The unit of a user-defined objective need not be that of its value.
    return f"{name} / {objective.unit}" if objective.name in SYMBOLS else name
