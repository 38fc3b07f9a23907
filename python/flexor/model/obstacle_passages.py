"""Obstacles that a body is beyond after a search for an equilibrium that is not nearby."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.errors import ModelWarning
from flexor.model.schema.obstacle import Obstacle
from flexor.model.schema.points import Attachment
from flexor.model.schema.touched import group_name

if TYPE_CHECKING:
    from flexor.model.results import Path

# Places on the way of a point that are looked at.
_PLACES = 33


def warn_about_passages(path: Path, start: Array) -> None:
    """Warn, in one sentence for each obstacle in the world, if points have come to its other side.

    That is, if the straight way of the centre of a sphere leads through the obstacle: from where
    the path begins to the first equilibrium, and from one that nothing holds, or that is left by a
    snap, to the next. These searches minimise the energy in long steps, which may pass over an
    obstacle.

    Parameters
    ----------
    path
        The path.
    start : (dof,) array
        Where it begins.
    """
    if path.model.file.obstacles:
        for step, before in _searches(path, start):
            for sentence in _passages(path, step, before):
                warnings.warn(sentence, ModelWarning, stacklevel=3)


def _searches(path: Path, start: Array) -> Iterator[tuple[int, Array]]:
    """Yield the steps before which an equilibrium was sought, and the states it was sought from."""
    if path.converged[0]:
        yield 0, start
    left = {event.step for event in path.events}
    for step in range(1, len(path)):
        sought = step in left or path.stability[step - 1] != "stable"
        if path.converged[step - 1] and path.converged[step] and sought:
            yield step, path.q[step - 1]


def _passages(path: Path, step: int, start: Array) -> Iterator[str]:
    model = path.model
    before = model.engine.spheres(path[0].parameters, start)[:, :3]
    after = model.engine.spheres(path[0].parameters, path.q[step])[:, :3]
    share = np.linspace(0.0, 1.0, _PLACES)[1:-1, None, None]
    where = "in the first equilibrium" if step == 0 else f"at step {step}"
    for name, obstacle in model.file.obstacles.items():
        if isinstance(obstacle.point, Attachment):
            continue
        origin, axes = obstacle.reference_pose(model.file)

        def distance(
            places: Array,
            obstacle: Obstacle = obstacle,
            origin: Array = origin,
            axes: Array = axes,
        ) -> Array:
            return np.asarray(obstacle.distance((places - origin) @ axes))

        groups = list(obstacle.spheres or ())
        groups += [group_name(body) for body in obstacle.skins(name, model.file)]
        ranges = [model.engine.sphere_groups[group] for group in groups]
        rows = np.concatenate([np.arange(first, last) for first, last in ranges])
        free = (distance(before[rows]) > 0.0) & (distance(after[rows]) > 0.0)
        ways = before[rows] + share * (after[rows] - before[rows])
        passed = rows[free & (distance(ways) < 0.0).any(axis=0)]
        if passed.size:
            bodies = dict.fromkeys(model.sphere_places[row][0] for row in passed)
            whose = " and ".join(f'"{body}"' for body in bodies)
            yield (
                f'obstacle "{name}" may have been passed: points of {whose} are on its other side '
                f"{where}; begin nearer to rest by [start], or in smaller steps."
            )
