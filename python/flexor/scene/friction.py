"""Points with friction: octahedra where it holds, cones along the force where it is overcome."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.scene.objects import Attached

if TYPE_CHECKING:
    from flexor.model import Path

SIDES = 8  # of a cone
SHARE = 0.011  # of the size of the model: half the height of a mark


def friction_objects(path: Path, frames: Mapping[str, Array]) -> Iterator[Attached]:
    """Yield the marks of points where friction holds, and of those where it is overcome.

    Cones point along the force on the first body, the exosuit's. A step has as many marks as points
    that touch; the others of the mesh are of size zero.

    Parameters
    ----------
    path
        Equilibria of one design.
    frames : dict of (s, m, 4, 4) arrays
        Frames of all bodies.
    """
    if not path.model.frictions:
        return
    steps = [path.friction_forces(step) for step in range(len(path))]
    points = np.concatenate([each[..., :3, 3].reshape(-1, 3) for each in frames.values()])
    size = SHARE * float(np.linalg.norm(np.ptp(points, axis=0)))
    for part, slides, (shape, faces) in (
        ("holds", False, _octahedron()),
        ("slides", True, _cone()),
    ):
        chosen = [np.flatnonzero(each.slides == slides) for each in steps]
        count = max(map(len, chosen))
        if not count:
            continue
        poses = np.zeros((len(steps), count, 4, 4))
        poses[..., 3, 3] = 1.0
        # Marks that are missing lie where a body begins.
        poses[..., :3, 3] = next(iter(frames.values()))[:, :1, :3, 3]
        for pose, each, rows in zip(poses, steps, chosen, strict=True):
            pose[: len(rows), :3, 3] = each.place[rows]
            pose[: len(rows), :3, :3] = size * _axes(each.force[rows])
        marks = np.arange(count)
        yield Attached(
            name="friction",
            kind="friction",
            part=part,
            faces=(faces + len(shape) * marks[:, None, None]).reshape(-1, 3),
            local=np.tile(shape, (count, 1)),
            frame=np.repeat(marks, len(shape)),
            frames=poses,
        )


def _axes(force: Array) -> Array:
    """Return rotations (m, 3, 3) whose first axes are the directions of forces (m, 3)."""
    length = np.linalg.norm(force, axis=1, keepdims=True)
    along = np.where(length > 0.0, force / np.where(length > 0.0, length, 1.0), np.eye(3)[0])
    across = np.cross(along, np.eye(3)[np.argmin(np.abs(along), axis=1)])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return np.stack([along, across, np.cross(along, across)], axis=2)


def _octahedron() -> tuple[Array, NDArray[np.intp]]:
    corners = np.concatenate([np.eye(3), -np.eye(3)])
    faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    return corners, np.array(faces, dtype=np.intp)


def _cone() -> tuple[Array, NDArray[np.intp]]:
    angle = np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False)
    ring = np.stack([np.full(SIDES, -1.0), np.cos(angle), np.sin(angle)], axis=1)
    corners = np.concatenate([ring, [[1.6, 0.0, 0.0], [-1.0, 0.0, 0.0]]])
    here = np.arange(SIDES)
    after = (here + 1) % SIDES
    sides = np.stack([here, after, np.full(SIDES, SIDES)], axis=1)
    base = np.stack([after, here, np.full(SIDES, SIDES + 1)], axis=1)
    return corners, np.concatenate([sides, base]).astype(np.intp)
