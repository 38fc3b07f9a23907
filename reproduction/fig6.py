"""Fig. 6: bending against force for the optimum of each objective."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from flexor.plot.style import COLUMN, LINE, style
from reproduction.optima import optimum
from reproduction.panels import draw_designs
from reproduction.study import LINEAR, OBJECTIVES, Data, Study, bending, follow, parameters

if TYPE_CHECKING:
    import flexor

# Colours of Okabe and Ito, each with a different marker and line style.
STYLES = (
    ("#0072B2", "o", "-"),
    ("#D55E00", "s", "--"),
    ("#009E73", "^", "-."),
    ("#CC79A7", "D", ":"),
    (LINE, "x", "-"),
)
LABELS = {
    "bending": "$f_b$",
    "tip-force": "$f_{exo}$",
    "bending-contact": "$f_{bc}$",
    "bending-contact-printed": "$f_{bc}$ as printed",
    "default": "default",
}


def compute(study: Study) -> Data:
    """Follow the optimum of each objective from 0 to 5 N."""
    paths = _paths(study)
    return {
        "force": paths["default"].force.tolist(),
        "bending": {
            name: [bending(path, step) for step in range(len(path))] for name, path in paths.items()
        },
    }


def draw(study: Study, data: Data) -> dict[str, Figure]:
    """Draw the curves and the designs."""
    paths = _paths(study)
    titles = {name: f"{LABELS[name]}: {data['bending'][name][-1]:.2f} rad" for name in OBJECTIVES}
    return {
        "fig6": _curves(data),
        "fig6-designs": draw_designs({titles[name]: paths[name] for name in OBJECTIVES}),
    }


def _paths(study: Study) -> dict[str, flexor.Path]:
    paths = {name: follow(LINEAR, optimum(study, LINEAR, name)["design"]) for name in OBJECTIVES}
    return {**paths, "default": follow(LINEAR, parameters(LINEAR).start)}


def _curves(data: Data) -> Figure:
    with style():
        figure = Figure(figsize=(COLUMN, 0.85 * COLUMN), layout="constrained")
        axes = figure.add_subplot()
        for i, (name, angles) in enumerate(data["bending"].items()):
            colour, marker, dash = STYLES[i]
            axes.plot(
                data["force"], angles, dash, color=colour, marker=marker, label=LABELS[name],
                # Later lines are thinner, so that coincident ones remain visible.
                linewidth=2.6 - 0.4 * i, markersize=6.5 - 0.8 * i,
                zorder=1.5 if name == "default" else 2.0,
            )  # fmt: skip
        axes.axhline(0.0, color="#D5DADE", linewidth=0.6, zorder=0)
        axes.set_xlabel("force / N")
        axes.set_ylabel("sum of the joint angles / rad")
        figure.legend(loc="outside upper center", ncols=3, handlelength=2.6)
    return figure
