"""Meshes of obstacles."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.model.schema import ModelFile
from flexor.model.schema.obstacle import HalfSpace, Obstacle
from flexor.model.schema.points import Attachment
from flexor.model.schema.solid import Solid
from flexor.scene.attachments import frame_of, place_of
from flexor.scene.objects import Attached, Object

if TYPE_CHECKING:
    from flexor.model import Path

_STEPS = 8  # of a quarter of a circle


def obstacle_objects(
    path: Path, frames: Mapping[str, Array], solid: list[Object], file: ModelFile
) -> Iterator[Object]:
    """Yield the mesh of each obstacle; what is endless is as large as what it stands beside."""
    if not file.obstacles:
        return
    points = np.concatenate([each.vertices(step) for each in solid for step in (0, -1)])
    half = 0.6 * float(np.linalg.norm(np.ptp(points, axis=0)))
    for name, obstacle in file.obstacles.items():
        poses = obstacle_poses(path, frames, obstacle)
        if isinstance(obstacle, HalfSpace):
            local, faces = _square(obstacle, poses, points.mean(axis=0), half)
        else:
            assert isinstance(obstacle, Solid)
            local, faces = _rounded(obstacle, half)
        yield Attached(
            name=name,
            kind="obstacle",
            part="",
            faces=faces[:, ::-1] if getattr(obstacle, "inside", False) else faces,
            local=local,
            frame=np.zeros(len(local), dtype=np.intp),
            frames=poses[:, None],
        )


def obstacle_poses(path: Path, frames: Mapping[str, Array], obstacle: Obstacle) -> Array:
    """Return the frame of an obstacle at each step, (..., 4, 4)."""
    steps = next(iter(frames.values())).shape[:-3]
    poses = np.broadcast_to(np.eye(4), (*steps, 4, 4)).copy()
    if isinstance(obstacle.point, Attachment):
        poses[..., :3, :3] = frame_of(path, frames, obstacle.point)[..., :3, :3] @ obstacle.axes
        poses[..., :3, 3] = place_of(path, frames, obstacle.point)
    else:
        poses[..., :3, :3] = obstacle.axes
        poses[..., :3, 3] = obstacle.point.components
    return poses


def _square(
    obstacle: HalfSpace, poses: Array, middle: Array, half: float
) -> tuple[Array, NDArray[np.intp]]:
    """Return a square of a plane, opposite the middle of what stands before it at last."""
    normal = np.array(obstacle.normal, dtype=float)
    normal /= np.linalg.norm(normal)
    first = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    last = poses[-1]
    seen = last[:3, :3].T @ (middle - last[:3, 3])
    centre = seen - (seen @ normal) * normal
    corners = [
        centre + half * (a * first + b * second)
        for a, b in ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
    ]
    return np.array(corners), np.array([[0, 1, 2], [0, 2, 3]], dtype=np.intp)


def _rounded(obstacle: Solid, endless: float) -> tuple[Array, NDArray[np.intp]]:
    """Return the surface of a rounded box: a sphere's, with its octants moved to the corners."""
    half = np.minimum(np.array(obstacle.half), endless)
    quarter = np.linspace(0.0, 0.5 * np.pi, _STEPS + 1)
    around = np.concatenate([quarter + k * 0.5 * np.pi for k in range(4)])
    signs = np.repeat([(1, 1), (-1, 1), (-1, -1), (1, -1)], _STEPS + 1, axis=0)
    up = np.concatenate([quarter - 0.5 * np.pi, quarter])
    sides = np.repeat([-1, 1], _STEPS + 1)
    directions = np.stack(
        [
            np.cos(up)[:, None] * np.cos(around),
            np.cos(up)[:, None] * np.sin(around),
            np.broadcast_to(np.sin(up)[:, None], (len(up), len(around))),
        ],
        axis=2,
    )
    corners = np.empty_like(directions)
    corners[..., :2] = signs * half[:2]
    corners[..., 2] = sides[:, None] * half[2]
    local = (corners + obstacle.rounded_by * directions).reshape(-1, 3)
    rows, columns = len(up), len(around)
    here = np.arange(rows * columns).reshape(rows, columns)
    after = np.roll(here, -1, axis=1)
    a, b, c, d = (x.ravel() for x in (here[:-1], after[:-1], after[1:], here[1:]))
    faces = [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
    # The faces at both ends of the last axis.
    for ring in (here[0, ::-1], here[-1]):
        faces.append(np.stack([np.full(columns - 2, ring[0]), ring[1:-1], ring[2:]], axis=1))
    return local, np.concatenate(faces).astype(np.intp)
