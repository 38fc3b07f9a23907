"""Ties as marks at their first places: balls, barrels along axes, and cubes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.model.schema import ModelFile
from flexor.model.schema.points import Attachment
from flexor.model.schema.tie import Tie
from flexor.scene.attachments import frame_of, place_of
from flexor.scene.objects import Attached, grid_faces

if TYPE_CHECKING:
    from flexor.model import Path

SIDES = 16
LARGER = 1.3  # than the thickest of the bodies that are tied
# Half the length and the radius of a barrel, of a hinge and of a slider.
BARRELS = {"hinge": (1.2, 0.7), "slider": (2.5, 0.5)}


def tie_objects(path: Path, frames: Mapping[str, Array], file: ModelFile) -> Iterator[Attached]:
    """Yield the mark of each tie: a ball for a pin, a cube for a weld, else a barrel on its axis.

    Parameters
    ----------
    path
        Equilibria of one design.
    frames : dict of (s, m, 4, 4) arrays
        Frames of all bodies.
    file
        The model file of the design.
    """
    for name, tie in file.ties.items():
        size = LARGER * max(_radius(path, end.body) for end in _bodies(tie))
        local, faces = _mark(tie)
        yield Attached(
            name=name,
            kind="tie",
            part="",
            faces=faces,
            local=size * local,
            frame=np.zeros(len(local), dtype=np.intp),
            frames=_poses(path, frames, tie)[:, None],
        )


def _bodies(tie: Tie) -> list[Attachment]:
    return [end for end in (tie.first, tie.second) if isinstance(end, Attachment)]


def _radius(path: Path, body: str) -> float:
    """Return the largest radius of a body [m]."""
    names = ["radius"] if body in path.model.rods else ["radius_base", "radius_tip"]
    found = [path.model.slot(f"{body}.{each}", path.parameters) for each in names]
    return float(np.max(np.concatenate(found)))


def _poses(path: Path, frames: Mapping[str, Array], tie: Tie) -> Array:
    """Return the frame of the first place at each step, (s, 4, 4)."""
    place = place_of(path, frames, tie.first)
    poses = np.broadcast_to(np.eye(4), (*place.shape[:-1], 4, 4)).copy()
    if isinstance(tie.first, Attachment):
        poses[..., :3, :3] = frame_of(path, frames, tie.first)[..., :3, :3]
    poses[..., :3, 3] = place
    return poses


def _mark(tie: Tie) -> tuple[Array, NDArray[np.intp]]:
    """Return vertices (v, 3) and faces of a mark of size one."""
    if tie.kind == "weld":
        corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
        sides = ("0132", "4675", "0451", "2376", "0264", "1573")
        squares = [[int(corner) for corner in side] for side in sides]
        faces = [[a, b, c] for a, b, c, _ in squares] + [[a, c, d] for a, _, c, d in squares]
        return corners, np.array(faces, dtype=np.intp)
    if tie.kind == "pin":
        angle = np.linspace(np.pi, 0.0, SIDES // 2 + 1)
        outline = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    else:
        half, radius = BARRELS[tie.kind]
        outline = np.array([[-half, 0.0], [-half, radius], [half, radius], [half, 0.0]])
    axis = np.array(tie.direction if tie.kind != "pin" else (1.0, 0.0, 0.0))
    first = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    turn = np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False)
    around = np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * second
    local = outline[:, 0, None, None] * axis + outline[:, 1, None, None] * around
    return local.reshape(-1, 3), grid_faces(len(outline), SIDES, closed=True)
