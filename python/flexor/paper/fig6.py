"""Fig. 6: how far the finger bends under the optimum of each objective."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexor.paper.context import Context
from flexor.paper.designs_figure import draw_designs
from flexor.paper.optimum import true_optimum
from flexor.paper.section import Column, Picture, Section, Table
from flexor.paper.settings import OBJECTIVES
from flexor.paper.table4 import PARAMETERS, SYMBOLS
from flexor.plot.style import COLUMN, LINE, style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexor.model import Path

# Okabe and Ito's colours, each with a marker and a dash of its own.
LOOKS = (
    ("#0072B2", "o", "-"),
    ("#D55E00", "s", "--"),
    ("#009E73", "^", "-."),
    ("#CC79A7", "D", ":"),
    (LINE, "x", "-"),
)
MATHEMATICAL = {
    "bending": "$f_b$",
    "tip-force": "$f_{exo}$",
    "bending-contact": "$f_{bc}$",
    "bending-contact-printed": "$f_{bc}$ as printed",
    "default": "default",
}


def fig6(context: Context) -> Section:
    """Follow the optimum of each objective from 0 to 5 N.

    Parameters
    ----------
    context : Context
        Models, settings and folder.

    Returns
    -------
    Section
        Fig. 6.
    """
    paths: dict[str, Path] = {}
    for name in OBJECTIVES:
        problem = context.problem(PARAMETERS, name)
        design = true_optimum(context, PARAMETERS, name).design
        paths[name] = context.path(problem, design)
    paths["default"] = context.path(context.problem(PARAMETERS), None)
    ends = {name: float(path.joint_angles[-1].sum()) for name, path in paths.items()}
    order = ", ".join(
        f"{SYMBOLS[name]} {ends[name]:.2f}" for name in sorted(OBJECTIVES, key=lambda n: -ends[n])
    )
    return Section(
        name="fig6",
        title="Fig. 6: bending under the optimum of each objective",
        text=(f"Sum of the joint angles at 5 N, by objective: {order} rad; "
              f"default {ends['default']:.2f} rad.",),
        tables=(_table(paths),),
        pictures=(
            Picture(
                "fig6",
                "Sum of the joint angles against the actuation force, for the optimum of L+R01 "
                "under each objective and for the default design.",
                _curves(paths),
            ),
            Picture(
                "fig6-designs",
                "The same optima at rest and at 5 N, to one scale.",
                draw_designs(
                    {f"{MATHEMATICAL[name]}: {ends[name]:.2f} rad": paths[name]
                     for name in OBJECTIVES}
                ),
            ),
        ),
    )  # fmt: skip


def _table(paths: dict[str, Path]) -> Table:
    force = paths["default"].force
    return Table(
        name="fig6",
        caption="Sum of the joint angles along the five paths.",
        columns=(
            Column("force", "N"),
            *(Column(SYMBOLS.get(name, name), "rad") for name in paths),
        ),
        rows=tuple(
            (
                float(load),
                *(float(path.joint_angles[step].sum()) for path in paths.values()),
            )
            for step, load in enumerate(force)
        ),
    )


def _curves(paths: dict[str, Path]) -> Figure:
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=(COLUMN, 0.85 * COLUMN), layout="constrained")
        axes = figure.add_subplot()
        for i, (name, path) in enumerate(paths.items()):
            colour, marker, dash = LOOKS[i]
            axes.plot(
                path.force,
                path.joint_angles.sum(axis=1),
                dash,
                color=colour,
                marker=marker,
                # Lines that fall together stay visible: the later ones are thinner.
                linewidth=2.6 - 0.4 * i,
                markersize=6.5 - 0.8 * i,
                label=MATHEMATICAL[name],
                zorder=1.5 if name == "default" else 2.0,
            )
        axes.axhline(0.0, color="#D5DADE", linewidth=0.6, zorder=0)
        axes.set_xlabel("force / N")
        axes.set_ylabel("sum of the joint angles / rad")
        figure.legend(loc="outside upper center", ncols=3, handlelength=2.6)
    return figure
