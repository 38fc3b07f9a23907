"""Springs as coils, and those that only pull as cords."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema import ModelFile
from flexor.scene.attachments import place_of
from flexor.scene.objects import Free, grid_faces

if TYPE_CHECKING:
    from flexor.model import Path

TURNS, AROUND, SIDES = 9, 8, 5
# Of a coil: its radius as a share of its length, at most so large [m]; its straight ends; its wire.
RADIUS, LARGEST, ENDS, WIRE = 0.05, 4e-3, 0.12, 0.2


def spring_objects(path: Path, frames: Mapping[str, Array], file: ModelFile) -> Iterator[Free]:
    """Yield each spring, whose coil is as wide all along a path.

    Parameters
    ----------
    path
        Equilibria of one design.
    frames : dict of (s, m, 4, 4) arrays
        Frames of all bodies.
    file
        The model file of the design.
    """
    for name, spring in file.springs.items():
        first = place_of(path, frames, spring.first)
        second = place_of(path, frames, spring.second)
        longest = float(np.linalg.norm(second - first, axis=1).max())
        radius = min(RADIUS * longest, LARGEST)
        line = _coil(0.0 if spring.slack else radius)
        yield Free(
            name=name,
            kind="spring",
            part="",
            faces=grid_faces(len(line), SIDES, closed=True),
            positions=_tube(line, first, second, WIRE * radius),
        )


def _coil(radius: float) -> Array:
    """Return the centre line (n, 3) of a coil of length 1 along x, in metres across."""
    if radius == 0.0:
        return np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    angle = np.linspace(0.0, 2.0 * np.pi * TURNS, TURNS * AROUND + 1)
    x = ENDS + (1.0 - 2.0 * ENDS) * np.linspace(0.0, 1.0, len(angle))
    coil = np.stack([x, radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    straight = [[0.0, 0.0, 0.0], [ENDS, 0.0, 0.0]], [[1.0 - ENDS, 0.0, 0.0], [1.0, 0.0, 0.0]]
    return np.concatenate([straight[0], coil, straight[1]])


def _tube(line: Array, first: Array, second: Array, wire: float) -> Array:
    """Return a tube about a line between two ends (s, 3) at every step, (s, n SIDES, 3)."""
    span = second - first
    axis = span / np.maximum(np.linalg.norm(span, axis=1), 1e-12)[:, None]
    # Across the plane of planar models, unless the spring itself is.
    lateral = np.array([0.0, 1.0, 0.0]) if (np.abs(axis[:, 1]) < 0.9).all() else np.eye(3)[2]
    side = lateral - (axis @ lateral)[:, None] * axis
    side = side / np.maximum(np.linalg.norm(side, axis=1), 1e-12)[:, None]
    across = np.stack([side, np.cross(axis, side)], axis=1)
    centre = first[:, None] + line[:, 0, None] * span[:, None] + line[:, 1:] @ across
    along = np.gradient(centre, axis=1)
    along = along / np.maximum(np.linalg.norm(along, axis=2), 1e-12)[..., None]
    # Away from the axis, and along it where the wire is straight.
    out = np.broadcast_to(line[:, 1:] @ across + 1e-9 * side[:, None], centre.shape)
    out = out - np.einsum("sni,sni->sn", out, along)[..., None] * along
    out = out / np.maximum(np.linalg.norm(out, axis=2), 1e-15)[..., None]
    other = np.cross(along, out)
    angle = np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False)
    ring = np.cos(angle)[:, None] * out[:, :, None] + np.sin(angle)[:, None] * other[:, :, None]
    return np.asarray((centre[:, :, None] + wire * ring).reshape(len(first), -1, 3))
