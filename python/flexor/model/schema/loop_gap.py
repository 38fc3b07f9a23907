"""The gap between a point and a link, a round cone, which a strap that loops around it closes."""

from __future__ import annotations

import numpy as np

from flexor.arrays import Array


def gaps(rows: Array) -> Array:
    """Return the distance of points from the surfaces of links, negative inside, (n,) [m].

    Parameters
    ----------
    rows : (n, 6) array
        The point in the frame of the link's base, x along the link, then the link's radii at base
        and tip and its length [m].
    """
    along, across, base, taper, length, x = _nearest(rows)
    return np.asarray(np.hypot(along - x, across) - base - x / length * taper)


def gap_slopes(rows: Array) -> Array:
    """Differentiate these, (n, 6).

    The place along the link is that of the least distance, so that its own motion does not count
    unless it is the end of the link.
    """
    along, across, _, taper, length, x = _nearest(rows)
    distance = np.hypot(along - x, across)
    fraction = x / length
    by_along = _ratio(along - x, distance)
    radial = _ratio(across, distance)
    at_tip = np.where(x == length, -by_along - taper / length, 0.0)
    found = [
        by_along,
        radial * _ratio(rows[:, 1], across),
        radial * _ratio(rows[:, 2], across),
        fraction - 1.0,
        -fraction,
        fraction * taper / length + at_tip,
    ]
    return np.stack(found, axis=1)


def _nearest(rows: Array) -> tuple[Array, Array, Array, Array, Array, Array]:
    """Return places along and across, radius at base, taper, length and the nearest place."""
    along, y, z, base, tip, length = rows.T
    across, taper = np.hypot(y, z), tip - base
    cone = length**2 - taper**2
    with np.errstate(divide="ignore", invalid="ignore"):
        shift = np.where(cone > 0.0, taper * across / np.sqrt(cone), np.copysign(np.inf, taper))
    return along, across, base, taper, length, np.clip(along + shift, 0.0, length)


def _ratio(above: Array, below: Array) -> Array:
    """Return quotients, zero where the denominator is."""
    return np.divide(above, below, out=np.zeros_like(above), where=below != 0.0)
