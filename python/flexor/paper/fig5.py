"""Fig. 5: the default and every optimal design, at 0 and 5 N."""

from __future__ import annotations

from math import degrees
from typing import TYPE_CHECKING

from flexor.paper.context import Context
from flexor.paper.designs_figure import draw_designs
from flexor.paper.optimum import true_optimum
from flexor.paper.section import Picture, Section
from flexor.paper.settings import SETS

if TYPE_CHECKING:
    from flexor.model import Path


def fig5(context: Context) -> Section:
    """Draw the default and the optimal design of every set before and after actuation.

    Parameters
    ----------
    context : Context
        Models, settings and folder.

    Returns
    -------
    Section
        Fig. 5.
    """
    paths = optimal_paths(context)
    bending = {name: float(path.joint_angles[-1].sum()) for name, path in paths.items()}
    most, default = max(SETS, key=lambda name: bending[name]), bending["default"]
    outdone = sum(bending[name] > default for name in SETS)
    return Section(
        name="fig5",
        title="Fig. 5: the optimal designs at 0 and 5 N",
        text=(
            f"{outdone} of {len(SETS)} optimal designs bend the finger further than the default "
            f"({degrees(default):.0f}°); furthest bends {most}, {degrees(bending[most]):.0f}°.",
        ),
        pictures=(
            Picture(
                "fig5",
                "The default design and the optimal design of each parameter set, at rest and at "
                "5 N, all to one scale.",
                draw_designs({f"{name}: {bending[name]:.2f} rad": paths[name] for name in paths}),
            ),
        ),
    )


def optimal_paths(context: Context) -> dict[str, Path]:
    """Return the paths of the default and of the optimal design of every set, from 0 to 5 N."""
    paths = {"default": context.path(context.problem("L"), None)}
    for name in SETS:
        paths[name] = context.path(context.problem(name), true_optimum(context, name).design)
    return paths
