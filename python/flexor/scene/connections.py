"""What holds a link away from the body that it hangs on: bones of a limb, brackets."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema.body import Link
from flexor.scene.objects import Free, grid_faces

if TYPE_CHECKING:
    from flexor.model import Path
    from flexor.model.schema import ModelFile

# Radius by the length, and sides.
RADIUS, SIDES = 0.04, 8


def connections(path: Path, frames: Mapping[str, Array], file: ModelFile) -> dict[str, Array]:
    """Return the straight lines from the tips of bodies to links that are placed away from them.

    Parameters
    ----------
    path
        Equilibria of one design.
    frames : dict of (..., m, 4, 4) arrays
        Frames of all bodies, of one step or of several.
    file
        The model file of the design.

    Returns
    -------
    dict of (..., 2, 3) arrays [m]
        By link, of those of which neither end is within the outline of the other body.
    """
    found = {}
    for name, body in file.bodies.items():
        if not isinstance(body, Link) or body.parent is None:
            continue
        ends = np.stack([frames[body.parent][..., -1, :3, 3], frames[name][..., 0, :3, 3]], axis=-2)
        apart = _outside(path, frames, body.parent, ends[..., 1, :])
        if apart and _outside(path, frames, name, ends[..., 0, :]):
            found[name] = ends
    return found


def connection_objects(path: Path, frames: Mapping[str, Array], file: ModelFile) -> Iterator[Free]:
    """Yield each of these lines as a bone."""
    angle = np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False)
    for name, ends in connections(path, frames, file).items():
        span = ends[:, 1] - ends[:, 0]
        length = np.linalg.norm(span, axis=1)
        along = span / np.maximum(length, 1e-12)[:, None]
        side = np.cross(along, np.eye(3)[np.argmin(np.abs(along), axis=1)])
        side /= np.linalg.norm(side, axis=1)[:, None]
        across = np.stack([side, np.cross(along, side)], axis=1)
        ring = RADIUS * length.max() * np.stack([np.cos(angle), np.sin(angle)], axis=1) @ across
        # Closed at its ends by rings without a radius.
        rings = [ends[:, :1] + 0.0 * ring, ends[:, :1] + ring, ends[:, 1:] + ring]
        rings.append(ends[:, 1:] + 0.0 * ring)
        yield Free(
            name=name,
            kind="link",
            part="bone",
            faces=grid_faces(len(rings), SIDES, closed=True),
            positions=np.concatenate(rings, axis=1),
        )


def _outside(path: Path, frames: Mapping[str, Array], name: str, point: Array) -> bool:
    """Whether points (..., 3) are farther from the axis of a body than its largest radius."""
    rod = name in path.model.rods
    names = ["radius"] if rod else ["radius_base", "radius_tip"]
    radius = max(float(path.model.slot(f"{name}.{each}", path.parameters).max()) for each in names)
    base, tip = frames[name][..., 0, :3, 3], frames[name][..., -1, :3, 3]
    span = tip - base
    share = ((point - base) * span).sum(axis=-1) / np.maximum((span**2).sum(axis=-1), 1e-24)
    nearest = base + np.clip(share, 0.0, 1.0)[..., None] * span
    return bool((np.linalg.norm(point - nearest, axis=-1) > radius).all())
