"""A path as an animation: one picture per load step, to one scale."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexor.errors import InputError
from flexor.plot import planar, spatial
from flexor.plot.reading import read_scene
from flexor.plot.scene import arrow_scale
from flexor.plot.style import COLUMN, EXOSUIT, style

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation

    from flexor.model import Path

_INTERVAL = 150  # ms


def animation(path: Path) -> FuncAnimation:
    """Animate a design along its loads, to scale.

    Parameters
    ----------
    path : Path
        Equilibria of the design; steps without one are left out.

    Returns
    -------
    matplotlib.animation.FuncAnimation
        Notebooks show it; its methods ``save("finger.gif")`` and ``to_jshtml()`` write it.

    Raises
    ------
    InputError
        If the path has no equilibrium.
    """
    from matplotlib.figure import Figure

    from flexor.plot.path_animation import PathAnimation

    steps = np.flatnonzero(path.converged).tolist()
    if not steps:
        raise InputError("the path has no equilibrium that could be drawn.")
    scenes = [read_scene(path, step) for step in steps]
    cm_per_newton, _ = arrow_scale(scenes)
    with style():
        figure = Figure(figsize=(COLUMN, COLUMN), layout="constrained")
        axes = figure.add_subplot(projection=None if path.model.planar else "3d")

    def draw(frame: int) -> None:
        scene = scenes[frame]
        with style():
            axes.clear()
            if path.model.planar:
                planar.frame_axes(axes, scenes)
                planar.draw_scene(axes, scene, colour=EXOSUIT)
                planar.draw_contact_forces(axes, scene, cm_per_newton=cm_per_newton)
                planar.draw_keys(axes, (0.0, 0.0), gravity=scene.gravity)
            else:
                spatial.frame_axes(axes, scenes)
                spatial.draw_scene(axes, scene, colour=EXOSUIT)
                spatial.draw_contact_forces(axes, scene, cm_per_newton=cm_per_newton)
            axes.set_title(path.model.show_loads(path.loads[steps[frame]]))

    return PathAnimation(figure, draw, frames=len(scenes), interval=_INTERVAL, blit=False)
