"""The drawing of a body with its dimensions, and the picture of its mould, as SVG."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.export.body import Body
from flexor.export.mould import Mould
from flexor.export.picture import draw
from flexor.plot.style import CHAMBER, EXOSUIT, FORCE, LINE, STRAP, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PARTS = {"lower": FORCE, "upper": "#56B4E9", "end": "#009E73", "lid": STRAP, "core": "#9AA5AE"}


def drawing(body: Body) -> str:
    """Return the drawing as SVG: from the side, cut in the middle, and three sections, in mm."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=(7.2, 3.0), layout="constrained")
        grid = figure.add_gridspec(2, 3, height_ratios=(1.0, 1.0))
        _side(figure.add_subplot(grid[0, :]), body)
        for column, share in enumerate((0.0, 0.5, 1.0)):
            _section(figure.add_subplot(grid[1, column]), body, share)
        return _svg(figure)


def picture(mould: Mould) -> str:
    """Return a picture of the parts of a mould, apart from one another, as SVG with a bitmap."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=(7.2, 2.9))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        _apart(axes, mould)
        axes.set_rasterization_zorder(10)
        return _svg(figure)


def making_figure(body: Body, mould: Mould | None) -> Figure:
    """Draw a body from above and below and cut along its middle, and the parts of its mould."""
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=(7.2, 2.2 if mould is None else 5.2))
        height = 1.0 if mould is None else 0.4
        for place, view in enumerate(((-55.0, 28.0), (-55.0, -40.0), (-75.0, 15.0))):
            axes = figure.add_axes((place / 3.0, 1.0 - height, 1.0 / 3.0, height))
            cut = body.solid.split_by_plane((0, 1, 0), 0)[0] if place == 2 else body.solid
            draw(axes, {"body": (cut, EXOSUIT)}, *view)
        if mould is not None:
            _apart(figure.add_axes((0.0, 0.0, 1.0, 0.6)), mould)
        return figure


def _apart(axes: Axes, mould: Mould) -> None:
    parts = mould.parts()
    low = np.min([solid.bounding_box()[:3] for solid in parts.values()], axis=0)
    high = np.max([solid.bounding_box()[3:] for solid in parts.values()], axis=0)
    size = 1.2 * float(high[2] - low[2])
    away = {
        "upper": (0.0, 0.0, size),
        "lower": (0.0, 0.0, -size),
        "end-base": (-size, 0.0, 0.0),
        "end-tip": (size, 0.0, 0.0),
        "lid-base": (-2.4 * size, 0.0, 0.0),
        "lid-tip": (2.4 * size, 0.0, 0.0),
    }
    draw(
        axes,
        {
            name: (solid.translate(away.get(name, (0, 0, 0))), PARTS[name.partition("-")[0]])
            for name, solid in parts.items()
        },
    )


def _side(axes: Axes, body: Body) -> None:
    """Draw the body cut along its middle, with its length and heights."""
    cap = 1e3 * body.options.cap * body.scale
    for part in body.parts:
        z = part.outer[:, :, 1]
        axes.fill_between(part.x, z.min(axis=1), z.max(axis=1), color=EXOSUIT, linewidth=0)
    for chamber in body.chambers:
        for part in body.parts:
            low, high = max(chamber.low, part.x[0]), min(chamber.high, part.x[-1])
            if chamber.cavity in part.cavities and high > low:
                x, outline = part.between(part.cavities[chamber.cavity], low, high)
                z = outline[:, :, 1]
                axes.fill_between(x, z.min(axis=1), z.max(axis=1), color="white", linewidth=0)
                axes.plot(x, z.min(axis=1), x, z.max(axis=1), color=LINE, linewidth=0.5)
    for end, (low, high) in {"base": (-cap, 0.0), "tip": (body.length, body.length + cap)}.items():
        if end in body.caps:
            z = body.end(end)[0][:, 1]
            axes.fill_between((low, high), z.min(), z.max(), color=CHAMBER, linewidth=0)
    for inlet in body.inlets:
        begin, _, level = inlet.place
        ends = {"base": -cap - 6.0, "tip": body.length + cap + 6.0}
        if inlet.end in ends:
            axes.plot((ends[inlet.end], begin), (level, level), color=FORCE, linewidth=1.5)
    for ear in body.ears:
        axes.plot(ear.slot_x, (ear.z, ear.z), color=STRAP, linewidth=2.5)
        axes.annotate(
            f"{ear.strap}: slots {ear.slot_x[0]:.1f} to {ear.slot_x[1]:.1f}",
            (0.5 * (ear.slot_x[0] + ear.slot_x[1]), ear.z),
            (0, -9),
            textcoords="offset points",
            ha="center",
            fontsize=5.5,
        )
    heights = [np.ptp(body.end(end)[0][:, 1]) for end in ("base", "tip")]
    top = max(float(part.outer[:, :, 1].max()) for part in body.parts)
    axes.annotate(
        "", (0.0, top + 3.0), (body.length, top + 3.0), arrowprops={"arrowstyle": "<->", "lw": 0.6}
    )
    axes.text(
        0.5 * body.length,
        top + 4.0,
        f"{body.length:.1f}, height {heights[0]:.1f} at the base and {heights[1]:.1f} at the tip",
        ha="center",
        fontsize=6.5,
    )
    axes.set_aspect("equal")
    axes.set_ylim(top=top + 8.0)
    axes.set_axis_off()


def _section(axes: Axes, body: Body, share: float) -> None:
    """Draw a section with its width and height."""
    x = share * body.length
    part = next(each for each in body.parts if x <= each.x[-1] + 1e-9)
    outer = part.at(part.outer, np.array([x]))[0]
    axes.fill(*outer.T, color=EXOSUIT, linewidth=0)
    for points in part.cavities.values():
        hole = part.at(points, np.array([x]))[0]
        axes.fill(*hole.T, facecolor="white", edgecolor=LINE, linewidth=0.5)
    width, height = np.ptp(outer, axis=0)
    axes.set_title(f"X = {share:g}: {width:.2f} wide, {height:.2f} high", fontsize=6.5)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _svg(figure: Figure) -> str:
    out = io.StringIO()
    metadata: dict[str, Any] = {"Date": None}
    figure.savefig(out, format="svg", metadata=metadata, dpi=200)
    text = out.getvalue()
    return text[text.index("<svg") :]
