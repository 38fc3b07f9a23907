"""Springs and obstacles as lines of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.plot.scene import Line
from flexor.plot.style import LINE
from flexor.scene.attachments import place_of

if TYPE_CHECKING:
    from flexor.model import Path

SPRING, OBSTACLE = "#009E73", LINE


def springs(path: Path, frames: dict[str, Array]) -> list[Line]:
    """Return a straight line for each spring."""
    lines = []
    for name, spring in path.model.file.springs.items():
        ends = [place_of(path, frames, end) for end in (spring.first, spring.second)]
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
