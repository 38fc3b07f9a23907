"""Figures as PNG, SVG or PDF.

`path` draws one design at every load, `animation` one after the other, `designs` two designs
before and after actuation, to scale, and `sizes` those for a population; `landscape` plots an
objective over one or two parameters, `front` designs between several objectives and `profiles` a
comparison of search methods; `save` writes a figure. Matplotlib is imported when the first figure
is drawn.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexor.design.drawn_file import drawn_file
from flexor.errors import InputError
from flexor.model.limbs import limbs
from flexor.plot.animation import animation
from flexor.plot.designs_figure import Design, draw_designs
from flexor.plot.front_figure import front
from flexor.plot.history import read_history, stated_inputs, varied_input
from flexor.plot.landscape_figure import landscape
from flexor.plot.path_figure import draw_path
from flexor.plot.profiles_figure import profiles
from flexor.plot.reading import bending, marked, read_scene
from flexor.plot.style import save, writable
from flexor.scene import scene as solid_scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexor.model import Path
    from flexor.model.schema import ModelFile
    from flexor.study import Sizes

MOST_SCENES = 12

__all__ = [
    "animation",
    "designs",
    "front",
    "landscape",
    "path",
    "profiles",
    "save",
    "sizes",
    "writable",
]


def path(path: Path) -> Figure:
    """Draw a design at every load step, to scale.

    Parameters
    ----------
    path : Path
        Equilibria of the design.

    Returns
    -------
    matplotlib.figure.Figure
        One column wide. Bodies are coloured by load: the last is filled, with arrows for contact
        forces and heights below rods for the pressure on skins. Where loads fall or not all states
        are stable, a panel below shows the joint angles over the load, with arrows along the path
        and dashes where it is not stable. Steps that have not converged are left out.

    Raises
    ------
    InputError
        If no step has converged.
    """
    steps = np.flatnonzero(path.converged)
    if len(steps) == 0:
        raise InputError("no load step has converged: there is nothing to draw.")
    history = read_history(path)
    if history is not None:
        # The panel has every step; in the scene, so many would hide one another.
        steps = steps[np.unique(np.linspace(0, len(steps) - 1, MOST_SCENES).round().astype(int))]
    scenes = [read_scene(path, int(step)) for step in steps]
    scenes[-1] = marked(scenes[-1], path, int(steps[-1]))
    planar_model = path.model.planar
    most = varied_input(path)
    size, unit = path.model.load_unit(most)
    loads = (path.loads[:, most] if path.loads.shape[1] else path.force)[steps] / size
    solid = None
    if not planar_model and len(path.model.rods) > 1 and history is None:
        # Bodies that hide one another, of which only the ends of the path can be told apart.
        solid, scenes, loads = solid_scene(path), [scenes[0], scenes[-1]], loads[[0, -1]]
    return draw_path(
        scenes,
        loads,
        planar_model=planar_model,
        history=history,
        unit=unit,
        inputs=stated_inputs(path, most),
        solid=solid,
    )


def designs(
    start_path: Path,
    best_path: Path,
    titles: tuple[str, str] = ("start", "best"),
    files: tuple[ModelFile | None, ModelFile | None] = (None, None),
) -> Figure:
    """Draw two designs side by side to the same scale, each at its first and last load.

    Parameters
    ----------
    start_path, best_path : Path
        Equilibria of both designs.
    titles : tuple of str
        Titles of the panels.
    files : tuple of ModelFile
        Model files of the designs, whose sections are drawn; those of the model unless given.

    Returns
    -------
    matplotlib.figure.Figure
        One page wide; planar rods are cut lengthwise, arrows are contact forces, and heights below
        rods the pressure on skins. The titles state the sum of the joint angles at the last load,
        and of how many limbs they are if not of one.
    """
    rows = zip(titles, (start_path, best_path), files, strict=True)
    panels = [_panel(*row) for row in rows]
    return draw_designs(panels, planar_model=start_path.model.planar)


def sizes(found: Sizes) -> Figure:
    """Draw sizes that serve a population side by side, to the same scale, as `designs`.

    Parameters
    ----------
    found : Sizes
        What `flexor.study.sizes` found.

    Returns
    -------
    matplotlib.figure.Figure
        One page wide, each size on the limb that the model file has, with how many it serves.
    """
    chosen, model = found.problem.parameters, found.problem.model
    panels = []
    for i, study in enumerate(found.studies):
        best, count = study.best, len(found.members(i))
        title = f"serves {count} of {len(found.wearers)}\nsize {i + 1}"
        panels.append(_panel(title, best.path, drawn_file(chosen, best.vector, model)))
    return draw_designs(panels, planar_model=model.planar)


def _panel(title: str, path: Path, file: ModelFile | None) -> Design:
    shown = path.model.show_loads
    return Design(
        title=title,
        first=read_scene(path, 0, file),
        last=read_scene(path, -1, file),
        first_load=shown(path.loads[0]),
        last_load=shown(path.loads[-1]),
        bending=bending(path),
        limbs=limbs(path.model),
        solid=None if path.model.planar else solid_scene(path, file),
    )
