"""Straps around a rod and the body that it is held to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema import ModelFile
from flexor.model.schema.strap import Strap
from flexor.scene.objects import Free, grid_faces
from flexor.scene.rods import Swept

if TYPE_CHECKING:
    from flexor.model import Path

# Directions in which a strap is pulled taut, and points around what it encloses.
DIRECTIONS, AROUND = 72, 48
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
        rod = rods[strap.rod]
        first, first_along = _rod_section(rod, strap.at)
        if strap.to.body in rods:
            second, second_along = _rod_section(rods[strap.to.body], strap.fraction(file))
        else:
            second, second_along = _link_section(path, strap, frames, file, first.mean(axis=1))
        points = np.concatenate([first, second], axis=1)
        along = np.concatenate(
            [
                np.broadcast_to(first_along[:, None], first.shape),
                np.broadcast_to(second_along[:, None], second.shape),
            ],
            axis=1,
        )
        yield _ribbon(name, points, along, first.mean(axis=1), second.mean(axis=1), rod, strap)


def _ribbon(
    name: str, points: Array, along: Array, first: Array, second: Array, rod: Swept, strap: Strap
) -> Free:
    """Return the hull of points (s, n, 3) around the line between two centres (s, 3)."""
    station = int(np.argmin(np.abs(rod.x - strap.at)))
    lateral = rod.frames[:, station, :3, 1]
    up = first - second
    up = up - np.einsum("si,si->s", up, lateral)[:, None] * lateral
    up = up / np.maximum(np.linalg.norm(up, axis=1), 1e-12)[:, None]
    angle = np.linspace(0.0, 2.0 * np.pi, DIRECTIONS, endpoint=False)
    direction = np.cos(angle)[:, None] * lateral[:, None] + np.sin(angle)[:, None] * up[:, None]
    farthest = np.argmax(np.einsum("sni,ski->skn", points, direction), axis=2)
    taken = np.take_along_axis(points, farthest[..., None], axis=1) + ABOVE * direction
    half = 0.5 * (WIDTH if strap.width is None else float(strap.width))
    side = half * np.take_along_axis(along, farthest[..., None], axis=1)
    return Free(
        name=name,
        kind="strap",
        part="",
        faces=grid_faces(2, DIRECTIONS, closed=True),
        positions=np.concatenate([taken - side, taken + side], axis=1),
    )


def _rod_section(rod: Swept, at: float) -> tuple[Array, Array]:
    """Return points around a rod's section (s, n, 3) and the direction of its axis (s, 3)."""
    station = int(np.argmin(np.abs(rod.x - at)))
    frame = rod.frames[:, station]
    across = rod.around(station)
    return frame[:, None, :3, 3] + across @ frame[:, :3, 1:3].transpose(0, 2, 1), frame[:, :3, 0]


def _link_section(
    path: Path, strap: Strap, frames: Mapping[str, Array], file: ModelFile, held: Array
) -> tuple[Array, Array]:
    """Return points around a link (s, n, 3) where the strap is, and the link's axis (s, 3)."""
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
    radius = ends[0] + share * (ends[1] - ends[0])
    angle = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    frame = frames[body][:, 0]
    around = circle @ frame[:, :3, 1:3].transpose(0, 2, 1)
    points = (base + share[:, None] * axis)[:, None] + radius[:, None, None] * around
    return points, frame[:, :3, 0]
