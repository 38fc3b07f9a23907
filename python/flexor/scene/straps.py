"""Straps around a rod and the body that it is held to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema import ModelFile
from flexor.model.schema.strap import Strap
from flexor.scene.links import profile
from flexor.scene.objects import Free, grid_faces
from flexor.scene.rods import Swept

if TYPE_CHECKING:
    from flexor.model import Path

# Directions in which a strap is pulled taut, and points around what it encloses.
DIRECTIONS, AROUND = 60, 48
# Sections across its width, so that it lies on tapered bodies.
ROWS = 5
# Where the file gives no width; and how far it is drawn above the surface [m].
WIDTH, ABOVE = 6e-3, 2.5e-4


def strap_objects(
    path: Path, rods: Mapping[str, Swept], frames: Mapping[str, Array], file: ModelFile
) -> Iterator[Free]:
    """Yield each strap as a taut ribbon, the convex hull of the sections that it encloses.

    Parameters
    ----------
    path
        Equilibria of one design.
    rods
        The rods, by name.
    frames : dict of (s, m, 4, 4) arrays
        Frames of all bodies.
    file
        The model file of the design.
    """
    for name, strap in file.straps.items():
        half = 0.5 * (WIDTH if strap.width is None else float(strap.width))
        offsets = np.linspace(-half, half, ROWS)
        rod = rods[strap.rod]
        held = _rod_section(rod, strap.at, 0.0)
        middle = held.mean(axis=1)
        if strap.to.body in rods:
            second, at = rods[strap.to.body], strap.fraction(file)
            others = [_rod_section(second, at, offset) for offset in offsets.tolist()]
        else:
            others = list(_link_sections(path, strap, frames, file, middle, offsets))
        rows = [
            np.concatenate([_rod_section(rod, strap.at, offset), other], axis=1)
            for offset, other in zip(offsets.tolist(), others, strict=True)
        ]
        centre = np.mean([row[:, held.shape[1] :].mean(axis=1) for row in rows], axis=0)
        station = int(np.argmin(np.abs(rod.x - strap.at)))
        direction = _directions(rod.frames[:, station, :3, 1], middle - centre)
        yield Free(
            name=name,
            kind="strap",
            part="",
            faces=grid_faces(ROWS, DIRECTIONS, closed=True),
            positions=np.concatenate([_hull(row, direction) for row in rows], axis=1),
        )


def _directions(lateral: Array, up: Array) -> Array:
    """Return directions around a line between centres, in its plane with the lateral (s, n, 3)."""
    up = up - np.einsum("si,si->s", up, lateral)[:, None] * lateral
    up = up / np.maximum(np.linalg.norm(up, axis=1), 1e-12)[:, None]
    angle = np.linspace(0.0, 2.0 * np.pi, DIRECTIONS, endpoint=False)
    return np.cos(angle)[:, None] * lateral[:, None] + np.sin(angle)[:, None] * up[:, None]


def _hull(points: Array, direction: Array) -> Array:
    """Return which of points (s, n, 3) is farthest in each direction, a little further out."""
    farthest = np.argmax(direction @ points.transpose(0, 2, 1), axis=2)
    return np.take_along_axis(points, farthest[..., None], axis=1) + ABOVE * direction


def _rod_section(rod: Swept, at: float, offset: float) -> Array:
    """Return points around a rod's section (s, n, 3), so far along its axis from a station."""
    station = int(np.argmin(np.abs(rod.x - (at + offset / rod.length))))
    frame = rod.frames[:, station]
    across = rod.around(station)
    return np.asarray(frame[:, None, :3, 3] + across @ frame[:, :3, 1:3].transpose(0, 2, 1))


def _link_sections(
    path: Path,
    strap: Strap,
    frames: Mapping[str, Array],
    file: ModelFile,
    held: Array,
    offsets: Array,
) -> Array:
    """Return points around a link (r, s, n, 3), so far along its axis from where the strap is."""
    body = strap.to.body
    base, tip = frames[body][:, 0, :3, 3], frames[body][:, -1, :3, 3]
    axis = tip - base
    if strap.listed() == "loops":
        share = np.einsum("si,si->s", held - base, axis) / np.einsum("si,si->s", axis, axis)
        share = np.clip(share, 0.0, 1.0)
    else:
        share = np.full(len(axis), strap.fraction(file))
    ends = [
        float(path.model.slot(f"{body}.radius_{end}", path.parameters)[0])
        for end in ("base", "tip")
    ]
    length = float(np.linalg.norm(axis[0]))
    along, radii = profile(length, *ends)
    x = np.clip(share * length + offsets[:, None], along[0], along[-1])
    radius = np.interp(x, along, radii)
    angle = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    around = circle @ frames[body][:, 0, :3, 1:3].transpose(0, 2, 1)
    centre = base + (x / length)[..., None] * axis
    return np.asarray(centre[:, :, None] + radius[..., None, None] * around)
