"""Solid rods whose sections are pressed or bent through themselves."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema import Rod
from flexor.model.schema.section import Solid
from flexor.model.schema.section_geometry import is_made_of_fibres

if TYPE_CHECKING:
    from flexor.model.path_quantities import PathQuantities

POINTS = 16  # on the outline of a disc


def least_stretches(path: PathQuantities) -> Iterator[tuple[str, Array]]:
    """Return the least stretch of the outline of each rod with a solid section and its own moduli.

    Parameters
    ----------
    path
        Equilibria of one design.

    Yields
    ------
    rod, stretch : str and (n, m) array
        Name of the rod, and the least stretch of the lines along its outline between each two of
        its sample points by steps, over their length at rest; NaN without equilibrium.

    Notes
    -----
    By the chords of these lines along the axis, which differ from the arcs by the square of the
    angle between the sample points, over 24.
    """
    rods = {
        name: (body, body.section)
        for name, body in path.model.file.bodies.items()
        if isinstance(body, Rod) and not is_made_of_fibres(body)
    }
    if not rods:
        return
    engine, own = path.model.engine, path.parameters
    rest = engine.frames(own, np.zeros(path.q.shape[1]))
    steps = [engine.frames(own, q) if np.isfinite(q).all() else None for q in path.q]
    for name, (_, section) in rods.items():
        assert isinstance(section, Solid)
        start, stop = path.model.body_frames[name]
        outline = _outline(section, path.model.slot(f"{name}.radius", path.parameters))
        lengths = _chords(rest[start:stop], outline)
        found = np.full((len(steps), lengths.shape[0]), np.nan)
        for k, frames in enumerate(steps):
            if frames is not None:
                found[k] = (_chords(frames[start:stop], outline) / lengths).min(axis=1)
        yield name, found


def _outline(section: Solid, radius: Array) -> Array:
    """Return points of the outline in each section, (sections, points, 3)."""
    if section.kind == "rectangular":
        unit = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])
    else:
        angle = np.linspace(0.0, 2.0 * np.pi, POINTS, endpoint=False)
        unit = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    unit = np.column_stack([np.zeros(len(unit)), (section.ratio or 1.0) * unit[:, 0], unit[:, 1]])
    outline: Array = radius[:, None, None] * unit
    return outline


def _chords(frames: Array, outline: Array) -> Array:
    """Return the chords of lines along the outline, along the axis, (sections - 1, points) [m]."""
    points = np.einsum("kij,kpj->kpi", frames[:, :3, :3], outline) + frames[:, None, :3, 3]
    axis = frames[:-1, :3, 0] + frames[1:, :3, 0]
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    chords: Array = np.einsum("kpi,ki->kp", np.diff(points, axis=0), axis)
    return chords
