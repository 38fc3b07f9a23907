"""Stiffness of the tip of a body against a force across it."""

from __future__ import annotations

import numpy as np

from flexor.arrays import Array
from flexor.model.results import Paths
from flexor.model.structure import Structure

# Step of a coordinate, in rad, 1/m or as a number, of central differences of a position.
_STEP = 1e-5


def bodies(model: Structure) -> dict[str, tuple[int, ...]]:
    """Return the bodies whose tip can move, with the coordinates that move it.

    No bodies where ties or friction add conditions to what the tangent says.
    """
    if model.file.ties or model.frictions:
        return {}
    found: dict[str, tuple[int, ...]] = {}
    for name in model.file.bodies:
        chain: list[str] = []
        each: str | None = name
        while each is not None:
            chain.append(each)
            each = model.file.bodies[each].parent
        columns = tuple(
            i
            for i, label in enumerate(model.engine.coordinates)
            if any(label.startswith(f"{body}.") for body in chain)
        )
        if columns:
            found[name] = columns
    return found


def tip_stiffness(paths: Paths, name: str, columns: tuple[int, ...]) -> Array:
    """Return force by distance for a force on the tip of a body, along its z [N/m], (n, s).

    All loads are held.
    """
    engine = paths.model.engine
    frame = engine.body_frames[name][1] - 1
    found = np.full(paths.q.shape[:2], np.nan)
    for i, step in np.argwhere(np.isfinite(paths.q).all(axis=2)):
        p, q = paths.parameters[i], paths.q[i, step]
        across = engine.frames(p, q)[frame, :3, 2]
        moved = np.zeros(len(q))
        for column in columns:
            off = np.zeros(len(q))
            off[column] = _STEP
            ends = [engine.frames(p, q + sign * off)[frame, :3, 3] for sign in (1.0, -1.0)]
            moved[column] = across @ (ends[0] - ends[1]) / (2.0 * _STEP)
        tangent = engine.tangent(p, q, paths.applied[i, step])
        try:
            yields = moved @ np.linalg.solve(tangent, moved)
        except np.linalg.LinAlgError:  # nothing resists some motion
            continue
        found[i, step] = 1.0 / yields if yields > 0.0 else np.nan
    return found
