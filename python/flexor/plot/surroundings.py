"""Springs, ties and obstacles as lines of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.plot.scene import Line
from flexor.plot.style import LINE
from flexor.scene.attachments import place_of

if TYPE_CHECKING:
    from flexor.model import Path

SPRING, TIE, OBSTACLE = "#009E73", "#CC79A7", LINE
RING = 0.015  # radius of the ring around a tie, as a share of the longest body


def springs(path: Path, frames: dict[str, Array]) -> list[Line]:
    """Return a straight line for each spring."""
    lines = []
    for name, spring in path.model.file.springs.items():
        ends = [place_of(path, frames, end) for end in (spring.first, spring.second)]
        lines.append(Line(name, np.array(ends), "spring", SPRING))
    return lines


def ties(path: Path, frames: dict[str, Array]) -> list[Line]:
    """Return a ring around each tie, and a line between its places where these are apart."""
    spans = (frame[-1, :3, 3] - frame[0, :3, 3] for frame in frames.values())
    radius = RING * max(float(np.linalg.norm(span)) for span in spans)
    angle = np.linspace(0.0, 2.0 * np.pi, 33)
    ring = radius * np.stack([np.cos(angle), np.zeros_like(angle), np.sin(angle)], axis=1)
    lines = []
    for name, tie in path.model.file.ties.items():
        ends = np.array([place_of(path, frames, end) for end in (tie.first, tie.second)])
        between = [*ends, ends[0]] if np.linalg.norm(ends[1] - ends[0]) > radius else []
        points = [*(ends[0] + ring), *between]
        lines.append(Line(name, np.array(points), f"tie ({tie.kind})", TIE))
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
