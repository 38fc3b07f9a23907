"""Figures to scale: finger and exosuit in place, as PNG, SVG or PDF.

`path` draws one design at every load, `designs` two designs before and after actuation,
`landscape` an objective over one or two parameters, `profiles` a comparison of search methods;
`save` writes any. Matplotlib is imported when the first figure is drawn.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexor.plot.designs_figure import Design, draw_designs
from flexor.plot.history import read_history
from flexor.plot.landscape_figure import draw_landscape
from flexor.plot.path_figure import draw_path
from flexor.plot.profiles_figure import draw_profiles
from flexor.plot.reading import read_scene
from flexor.plot.style import save, writable

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from flexor.model import Path
    from flexor.study.comparison import MethodComparison
    from flexor.study.landscape import Landscape, SearchPath

MOST_SCENES = 12

__all__ = ["designs", "landscape", "path", "profiles", "save", "writable"]


def path(path: Path) -> Figure:
    """Draw a design at every load step, to scale.

    Parameters
    ----------
    path : Path
        Equilibria of the design.

    Returns
    -------
    matplotlib.figure.Figure
        As wide as a column: rods and links coloured by load, contact forces as arrows. Of a path
        whose loads fall or whose states are not all stable, a panel below shows the joint angles
        over the load, with arrows along the path and dashes where it is not stable.
    """
    history = read_history(path)
    steps = range(len(path))
    if history is not None:
        # The panel has every step; in the scene, so many would hide one another.
        found = np.flatnonzero(path.converged)
        steps = found[np.unique(np.linspace(0, len(found) - 1, MOST_SCENES).round().astype(int))]
    scenes = [read_scene(path, int(step)) for step in steps]
    planar_model = path.model.planar
    return draw_path(scenes, path.force[list(steps)], planar_model=planar_model, history=history)


def designs(
    start_path: Path, best_path: Path, titles: tuple[str, str] = ("start", "best")
) -> Figure:
    """Draw two designs side by side to one scale, each at its first and its last load.

    Parameters
    ----------
    start_path, best_path : Path
        Equilibria of both.
    titles : tuple of str
        What to call them.

    Returns
    -------
    matplotlib.figure.Figure
        As wide as a page, the sum of the joint angles at the last load in the titles.
    """
    panels = [
        Design(
            title=title,
            first=read_scene(shown, 0),
            last=read_scene(shown, -1),
            first_load=float(shown.force[0]),
            last_load=float(shown.force[-1]),
            bending=float(shown.joint_angles[-1].sum()) if shown.joint_angles.shape[1] else None,
        )
        for title, shown in zip(titles, (start_path, best_path), strict=True)
    ]
    return draw_designs(panels, planar_model=start_path.model.planar)


def landscape(landscape: Landscape, paths: Sequence[SearchPath] = ()) -> Figure:
    """Draw an objective over one or two parameters.

    Parameters
    ----------
    landscape : Landscape
        What `flexor.landscape` gave.
    paths : sequence of SearchPath
        Searches of the same parameter set to lay over it, from start to end.

    Returns
    -------
    matplotlib.figure.Figure
        In perspective and from above, as wide as a page; or a curve, as wide as a column. Its
        minimum, the designs that snap on their way and those that failed are marked.
    """
    return draw_landscape(landscape, paths)


def profiles(comparison: MethodComparison, within: float = 0.01) -> Figure:
    """Draw how many of its problems each method of a comparison solves at what cost.

    Parameters
    ----------
    comparison : MethodComparison
        What `flexor.compare` gave.
    within : float
        Part of the best known gain that a solution may lack.

    Returns
    -------
    matplotlib.figure.Figure
        Performance profile and data profile, as wide as a page.
    """
    from flexor.study.comparison import data_profiles, performance_profiles

    sets, seeds = len(comparison.sets), len(comparison.seeds)
    return draw_profiles(
        performance_profiles(comparison, within),
        data_profiles(comparison, within),
        problems=f"{sets} set{'s' * (sets > 1)} × {seeds} seed{'s' * (seeds > 1)}",
        within=within,
    )
