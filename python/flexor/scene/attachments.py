"""Where points that are fixed to bodies are, such as the ends of springs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema.points import Attachment, Ground

if TYPE_CHECKING:
    from flexor.model import Path


def place_of(path: Path, frames: Mapping[str, Array], end: Attachment | Ground) -> Array:
    """Return the place of a point in the world.

    Parameters
    ----------
    path
        Equilibria of one design.
    frames : dict of (..., m, 4, 4) arrays
        Frames of all bodies, of one step or of several.
    end
        The point.

    Returns
    -------
    (..., 3) array [m]
    """
    if isinstance(end, Ground):
        steps = next(iter(frames.values())).shape[:-3]
        return np.broadcast_to(np.array(end.world.components, dtype=float), (*steps, 3))
    along = frames[end.body]
    station = end.lower_point(path.model.file.bodies)["station"]
    offset = np.array(end.offset.components, dtype=float)
    if isinstance(station, dict) and "point" in station:
        frame = along[..., station["point"], :, :]
        return _moved(frame, offset)
    base, tip = along[..., 0, :3, 3], along[..., -1, :3, 3]
    share = _centroid(path, end.body) if station == "centroid" else station["fraction"]
    return _moved(along[..., 0, :, :], offset) + share * (tip - base)


def frame_of(path: Path, frames: Mapping[str, Array], point: Attachment) -> Array:
    """Return the frame (..., 4, 4) that a point moves with, of one step or of several."""
    station = point.lower_point(path.model.file.bodies)["station"]
    place = station["point"] if isinstance(station, dict) and "point" in station else 0
    return np.asarray(frames[point.body][..., place, :, :])


def _moved(frame: Array, offset: Array) -> Array:
    return np.asarray(frame[..., :3, 3] + frame[..., :3, :3] @ offset)


def _centroid(path: Path, link: str) -> float:
    """Return where the centroid of a conical frustum is, as a share of its length."""
    a, b = (
        float(path.model.slot(f"{link}.radius_{end}", path.parameters)[0])
        for end in ("base", "tip")
    )
    return (a**2 + 2.0 * a * b + 3.0 * b**2) / (4.0 * (a**2 + a * b + b**2))
