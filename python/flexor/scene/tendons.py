"""Tendons as cords along their paths, and wraps as the spheres and cylinders that they are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema import ModelFile
from flexor.model.schema.obstacle import turning
from flexor.model.schema.points import Attachment, Ground
from flexor.model.schema.wrap import Wrap
from flexor.scene.attachments import frame_of, place_of
from flexor.scene.objects import Attached, Free, Object, grid_faces

if TYPE_CHECKING:
    from flexor.model import Path

# Radius of a cord by the longest body; places along each of its branches; sides.
RADIUS, PLACES, SIDES = 0.008, 60, 6
# Of a wrap: sides, rings of a sphere, and half the length of a cylinder by its radius.
AROUND, RINGS, HALF = 24, 12, 1.0


def tendon_objects(path: Path, frames: Mapping[str, Array], file: ModelFile) -> Iterator[Object]:
    """Yield each branch of each tendon, and each wrap.

    Parameters
    ----------
    path
        Equilibria of one design.
    frames : dict of (s, m, 4, 4) arrays
        Frames of all bodies.
    file
        The model file of the design.
    """
    if not file.tendons:
        return
    spans = (frame[0, -1, :3, 3] - frame[0, 0, :3, 3] for frame in frames.values())
    radius = RADIUS * max(float(np.linalg.norm(span)) for span in spans)
    paths = tendon_paths(path)
    for index, name in enumerate(file.tendons):
        for branch in range(len(paths[0][index])):
            lines = np.stack([resampled(step[index][branch], PLACES) for step in paths])
            yield Free(
                name=name,
                kind="tendon",
                part="",
                faces=grid_faces(PLACES, SIDES, closed=True),
                positions=_tube(lines, radius),
            )
    for name, wrap in file.wraps.items():
        yield _wrap(path, frames, name, wrap)


def tendon_paths(path: Path) -> list[list[list[Array]]]:
    """Return the places along each branch of each tendon at each step, (k, 3) arrays.

    A step without equilibrium has those of the last one that has.
    """
    model, last, found = path.model, np.zeros(path.model.dof), []
    for q in path.q:
        last = q if np.isfinite(q).all() else last
        tendons = model.engine.tendon_paths(path.parameters, last)
        found.append([[np.array(branch) for branch in branches] for branches in tendons])
    return found


def resampled(line: Array, count: int) -> Array:
    """Return so many places evenly along a line (k, 3)."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    at = np.linspace(0.0, along[-1], count)
    return np.stack([np.interp(at, along, line[:, i]) for i in range(3)], axis=1)


def wrap_poses(path: Path, frames: Mapping[str, Array], wrap: Wrap) -> Array:
    """Return the poses (..., 4, 4) of a wrap, z along a cylinder, of one step or of several."""
    if isinstance(wrap.point, Attachment):
        pose = np.array(frame_of(path, frames, wrap.point))
        pose[..., :3, 3] = place_of(path, frames, wrap.point)
    else:
        steps = next(iter(frames.values())).shape[:-3]
        pose = np.broadcast_to(np.eye(4), (*steps, 4, 4)).copy()
        pose[..., :3, 3] = place_of(path, frames, Ground(world=wrap.point))
    pose[..., :3, :3] = pose[..., :3, :3] @ _turned(wrap.direction or [0.0, 0.0, 1.0])
    return pose


def _turned(axis: list[float]) -> Array:
    """Return a rotation (3, 3) that leads from z to an axis."""
    z = np.array([0.0, 0.0, 1.0])
    across, along = np.cross(z, axis), float(np.dot(z, axis))
    sine = float(np.linalg.norm(across))
    if sine < 1e-12:
        return np.diag([1.0, 1.0, 1.0]) if along > 0.0 else np.diag([1.0, -1.0, -1.0])
    x, y, w = across / sine * np.arctan2(sine, along)
    return turning((float(x), float(y), float(w)))


def _wrap(path: Path, frames: Mapping[str, Array], name: str, wrap: Wrap) -> Attached:
    radius = float(path.model.slot(f"{name}.radius", path.parameters)[0])
    angle = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)
    if wrap.kind == "sphere":
        tilt = np.linspace(0.0, np.pi, RINGS + 1)
        rings = radius * np.stack([np.sin(tilt), -np.cos(tilt)], axis=1)
    else:
        half = HALF * radius
        rings = np.array([[0.0, -half], [radius, -half], [radius, half], [0.0, half]])
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    local = np.concatenate(
        [np.column_stack([r * around, np.full(AROUND, z)]) for r, z in rings.tolist()]
    )
    return Attached(
        name=name,
        kind="wrap",
        part="",
        faces=grid_faces(len(rings), AROUND, closed=True),
        local=local,
        frame=np.zeros(len(local), dtype=np.intp),
        frames=wrap_poses(path, frames, wrap)[:, None],
    )


def _tube(lines: Array, radius: float) -> Array:
    """Return a tube about lines (s, n, 3) at every step, (s, n SIDES, 3)."""
    along = np.gradient(lines, axis=1)
    along = along / np.maximum(np.linalg.norm(along, axis=2), 1e-12)[..., None]
    # Carried from place to place, so that the tube does not twist.
    side = np.empty_like(along)
    least = np.argmin(np.abs(along[:, 0]), axis=1)
    before = np.eye(3)[least]
    for k in range(along.shape[1]):
        before = before - (before * along[:, k]).sum(axis=1)[:, None] * along[:, k]
        before = before / np.maximum(np.linalg.norm(before, axis=1), 1e-12)[:, None]
        side[:, k] = before
    other = np.cross(along, side)
    angle = np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False)
    ring = np.cos(angle)[:, None] * side[:, :, None] + np.sin(angle)[:, None] * other[:, :, None]
    return np.asarray((lines[:, :, None] + radius * ring).reshape(len(lines), -1, 3))
