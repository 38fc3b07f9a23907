"""The parting surface of a mould: where its halves meet, and undercuts, which it cannot hold."""

from __future__ import annotations

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.export.outlines import Segment

_TOLERANCE = 1e-6  # [mm]


def parting_heights(part: Segment) -> Array:
    """Return the height z of the parting surface at the stations of a segment [mm], (k,).

    The lowest place where the outline is widest: the underside where that is flat, so that the
    lower half is a plate on which a layer lies; the middle of a tube.
    """
    return np.array([_widest(outline) for outline in part.outer])


def _widest(outline: Array) -> float:
    y, z = outline[:, 0], outline[:, 1]
    near = _TOLERANCE + 1e-6 * (y.max() - y.min())
    return float(max(z[y > y.max() - near].min(), z[y < y.min() + near].min()))


def half_outlines(part: Segment, heights: Array, sign: float) -> Array | None:
    """Return the outlines of what is to be cut out of one half of a mould, (k, m, 2) [mm].

    It goes a little beyond the parting surface, so that no faces coincide there.

    Parameters
    ----------
    part
        The segment.
    heights : (k,) array
        Those of the parting surface.
    sign
        1 for the upper half, -1 for the lower one.

    Returns
    -------
    (k, m, 2) array or None
        None if nothing of the body is in that half.
    """
    depth = sign * (part.outer[:, :, 1] - heights[:, None])
    if depth.max() < _TOLERANCE:
        return None
    chain = _chain(depth)
    if chain is None:
        return part.outer
    outlines = part.outer[:, chain]
    beyond = heights - sign
    last = np.stack([outlines[:, -1, 0], beyond], axis=1)[:, None]
    first = np.stack([outlines[:, 0, 0], beyond], axis=1)[:, None]
    return np.concatenate([outlines, last, first], axis=1)


def _chain(depth: Array) -> Array | None:
    """Return the corners on one side of the parting surface, between two that lie on it.

    None if they do not follow one another, or are not the same at all stations.
    """
    inside = np.all(depth > _TOLERANCE, axis=0)
    on = np.all(np.abs(depth) <= _TOLERANCE, axis=0)
    begins = np.flatnonzero(inside & ~np.roll(inside, 1))
    if len(begins) != 1:
        return None
    chain = (begins[0] - 1 + np.arange(int(inside.sum()) + 2)) % depth.shape[1]
    return chain if on[chain[0]] and on[chain[-1]] else None


def check_undercuts(part: Segment, heights: Array, place: str) -> None:
    """Check that the halves of a mould come off along z.

    Raises
    ------
    InputError
        Naming the place where they do not.
    """
    for x, outline, height in zip(part.x, part.outer, heights, strict=True):
        low, high = outline[:, 0].min(), outline[:, 0].max()
        columns = low + (high - low) * (np.arange(64) + 0.5) / 64.0
        for y in columns:
            ends = _crossings(outline, float(y))
            near = 1e-3 * (high - low)
            if len(ends) == 2 and ends[0] < height + near and ends[1] > height - near:
                continue
            depth = ends[2] - ends[1] if len(ends) > 2 else ends[0] - height
            raise InputError(
                f"{place} has an undercut of {abs(depth):.2g} mm at X = {x / part.x[-1]:.3g}, "
                f"y = {y:.3g} mm: the halves of a mould, which come off along z, cannot release it."
            )


def _crossings(outline: Array, y: float) -> Array:
    """Return the heights at which a polygon crosses a line along z, ascending."""
    a, b = outline, np.roll(outline, -1, axis=0)
    cross = (a[:, 0] > y) != (b[:, 0] > y)
    share = (y - a[cross, 0]) / (b[cross, 0] - a[cross, 0])
    return np.sort(a[cross, 1] + share * (b[cross, 1] - a[cross, 1]))
