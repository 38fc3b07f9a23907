"""Springs and obstacles as lines of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema.points import Attachment, Ground
from flexor.plot.scene import Line
from flexor.plot.style import LINE

if TYPE_CHECKING:
    from flexor.model import Path

SPRING, OBSTACLE = "#009E73", LINE


def springs(path: Path, frames: dict[str, Array]) -> list[Line]:
    """Return a straight line for each spring."""
    lines = []
    for name, spring in path.model.file.springs.items():
        ends = [_place(path, frames, end) for end in (spring.first, spring.second)]
        lines.append(Line(name, np.array(ends), "spring", SPRING))
    return lines


def planes(path: Path, low: Array, high: Array) -> list[Line]:
    """Return the outline of a square of each half-space, opposite bodies between two corners."""
    lines, middle, size = [], 0.5 * (low + high), high - low
    for name, obstacle in path.model.file.obstacles.items():
        normal = np.array(obstacle.normal, dtype=float)
        normal /= np.linalg.norm(normal)
        given = np.array(obstacle.point.components, dtype=float)
        centre = middle - ((middle - given) @ normal) * normal
        first = np.cross(normal, (0.0, 1.0, 0.0) if abs(normal[1]) < 0.9 else (1.0, 0.0, 0.0))
        first /= np.linalg.norm(first)
        second = np.cross(normal, first)
        half = 0.5 * float(np.linalg.norm(size[[0, 2]] if path.model.planar else size))
        corners = [(1, 1), (1, -1), (-1, -1), (-1, 1), (1, 1)]
        points = [centre + half * (a * first + b * second) for a, b in corners]
        lines.append(Line(name, np.array(points), "obstacle", OBSTACLE))
    return lines


def _place(path: Path, frames: dict[str, Array], end: Attachment | Ground) -> Array:
    """Return where an end of a spring is, in the world."""
    if isinstance(end, Ground):
        return np.array(end.world.components, dtype=float)
    file, along = path.model.file, frames[end.body]
    station = end.lower_point(file.bodies)["station"]
    if isinstance(station, dict) and "point" in station:
        frame, x = along[station["point"]], 0.0
    else:
        base, tip = along[0], along[-1]
        share = _centroid(path, end.body) if station == "centroid" else station["fraction"]
        frame, x = base, share * float(np.linalg.norm(tip[:3, 3] - base[:3, 3]))
    offset = np.array(end.offset.components, dtype=float)
    offset[0] += x
    return np.asarray(frame[:3, :3] @ offset + frame[:3, 3])


def _centroid(path: Path, link: str) -> float:
    """Return where the centroid of a conical frustum is, as a share of its length."""
    a, b = (
        float(path.model.slot(f"{link}.radius_{end}", path.parameters)[0])
        for end in ("base", "tip")
    )
    return (a**2 + 2.0 * a * b + 3.0 * b**2) / (4.0 * (a**2 + a * b + b**2))
