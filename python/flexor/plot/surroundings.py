"""Springs, tendons, ties and obstacles as lines of a scene."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema.obstacle import HalfSpace
from flexor.model.schema.points import Attachment
from flexor.model.schema.solid import Solid
from flexor.model.schema.vector import Offset
from flexor.plot.scene import Line
from flexor.plot.style import LINE
from flexor.scene.attachments import place_of
from flexor.scene.connections import connections
from flexor.scene.obstacles import obstacle_poses
from flexor.scene.tendons import wrap_poses

if TYPE_CHECKING:
    from flexor.model import Path

SPRING, TIE, OBSTACLE = "#009E73", "#CC79A7", LINE
TENDON, WRAP, GUIDES = "#B2182B", "#9ECAE1", "#E69F00"
GUIDE = 1.5e-3  # half the length of the line across a tendon at its guides [m]
RING = 0.015  # radius of the ring around a tie, as a share of the longest body


def bones(path: Path, frames: dict[str, Array]) -> list[Line]:
    """Return a line to each link that is placed away from the body that it hangs on."""
    found = connections(path, frames, path.model.file)
    return [Line(name, ends, "", LINE) for name, ends in found.items()]


def springs(path: Path, frames: dict[str, Array]) -> list[Line]:
    """Return a straight line for each spring."""
    lines = []
    for name, spring in path.model.file.springs.items():
        ends = [place_of(path, frames, end) for end in (spring.first, spring.second)]
        lines.append(Line(name, np.array(ends), "spring", SPRING))
    return lines


def tendons(path: Path, frames: dict[str, Array], step: int) -> list[Line]:
    """Return a line for each branch of each tendon at a step, its guides and a circle a wrap."""
    lines = []
    if names := path.model.tendons:
        found = path.model.engine.tendon_paths(path.parameters, path.q[step])
        for name, branches in zip(names, found, strict=True):
            lines += [Line(name, np.array(branch), "tendon", TENDON) for branch in branches]
        for name in names:
            lines += _guides(path, frames, name)
    angle = np.linspace(0.0, 2.0 * np.pi, 49)
    flat = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    for name, wrap in path.model.file.wraps.items():
        pose = wrap_poses(path, frames, wrap)
        radius = float(path.model.slot(f"{name}.radius", path.parameters)[0])
        # In the plane of a planar model a sphere is what it is cut to.
        circle = flat[:, [0, 2, 1]] if wrap.kind == "sphere" else flat
        points = radius * circle @ pose[:3, :3].T + pose[:3, 3]
        lines.append(Line(name, points, "wrap", WRAP))
    return lines


def _guides(path: Path, frames: dict[str, Array], name: str) -> Iterator[Line]:
    """Yield a short line across a tendon at each point of a body that it passes or ends at."""
    for stage in path.model.file.tendons[name].path:
        if isinstance(stage, Attachment) and any(stage.offset.components):
            point = place_of(path, frames, stage)
            out = point - place_of(path, frames, stage.model_copy(update={"offset": Offset()}))
            half = GUIDE * out / np.linalg.norm(out)
            yield Line(name, np.array([point - half, point + half]), "guide of a tendon", GUIDES)


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


def obstacles(path: Path, frames: dict[str, Array], low: Array, high: Array) -> list[Line]:
    """Return outlines of obstacles, of endless ones opposite bodies between two corners."""
    lines: list[Line] = []
    found = path.model.file.obstacles
    if not found:
        return lines
    size = (high - low)[[0, 2]] if path.model.planar else high - low
    half = 0.5 * float(np.linalg.norm(size))
    for name, obstacle in found.items():
        pose = obstacle_poses(path, frames, obstacle)
        if isinstance(obstacle, HalfSpace):
            outlines = [_square(obstacle, pose, 0.5 * (low + high), half)]
        else:
            assert isinstance(obstacle, Solid)
            sections = [(0, 2)] if path.model.planar else [(0, 2), (0, 1), (1, 2)]
            outlines = [_section(obstacle, pair, half) for pair in sections]
        for local in outlines:
            points = local @ pose[:3, :3].T + pose[:3, 3]
            lines.append(Line(name, points, "obstacle", OBSTACLE))
    return lines


def _square(obstacle: HalfSpace, pose: Array, middle: Array, half: float) -> Array:
    normal = np.array(obstacle.normal, dtype=float)
    normal /= np.linalg.norm(normal)
    seen = pose[:3, :3].T @ (middle - pose[:3, 3])
    centre = seen - (seen @ normal) * normal
    first = np.cross(normal, (0.0, 1.0, 0.0) if abs(normal[1]) < 0.9 else (1.0, 0.0, 0.0))
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    corners = [(1, 1), (1, -1), (-1, -1), (-1, 1), (1, 1)]
    return np.array([centre + half * (a * first + b * second) for a, b in corners])


def _section(obstacle: Solid, axes: tuple[int, int], endless: float) -> Array:
    """Return the outline (m, 3) in the plane of two of the obstacle's axes, in these."""
    quarter = np.linspace(0.0, 0.5 * np.pi, 17)
    angles = np.concatenate([quarter + k * 0.5 * np.pi for k in range(4)])
    corners = np.repeat([(1, 1), (-1, 1), (-1, -1), (1, -1)], len(quarter), axis=0)
    half = np.minimum(np.array(obstacle.half), endless)[list(axes)]
    local = np.zeros((len(angles), 3))
    turned = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    local[:, list(axes)] = corners * half + obstacle.rounded_by * turned
    return np.concatenate([local, local[:1]])
