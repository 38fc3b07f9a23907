"""Figures of designs at rest and at the last load, side by side to one scale."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from flexor.paper.scenes_figure import Layer, Panel, chamber_handle, draw_panels
from flexor.plot.reading import read_scene
from flexor.plot.style import EXOSUIT, LINE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexor.model import Path

AT_REST = "#C3CBD2"
COLUMNS = 4


def draw_designs(paths: Mapping[str, Path]) -> Figure:
    """Draw designs at rest and at their last load.

    Parameters
    ----------
    paths : dict of Path
        Paths from 0 N by the title of their panel; all of one set of constants.

    Returns
    -------
    matplotlib.figure.Figure
        As wide as a page.
    """
    from matplotlib.patches import Patch

    scenes = {title: (read_scene(path, 0), read_scene(path, -1)) for title, path in paths.items()}
    panels = [
        Panel(title, [Layer(rest, AT_REST, 0.45), Layer(bent, EXOSUIT, 0.95)])
        for title, (rest, bent) in scenes.items()
    ]
    force = next(iter(paths.values())).force[-1]
    handles = [
        Patch(facecolor=AT_REST, edgecolor=LINE, linewidth=0.5, label="exosuit at 0 N"),
        Patch(facecolor=EXOSUIT, edgecolor=LINE, linewidth=0.5, label=f"at {force:g} N"),
        chamber_handle(next(iter(scenes.values()))[0]),
    ]
    return draw_panels(panels, COLUMNS, handles)
