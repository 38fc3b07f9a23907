"""Outlines and surfaces of tapered bodies, as arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from flexor.arrays import Array


def band(centre: ArrayLike, normal: ArrayLike, half_height: ArrayLike) -> Array:
    """Return the closed outline (2 m + 1, 2) of a soft rod in its plane.

    Centre line (m, 2) and its unit normals (m, 2) run from base to tip; the dorsal edge comes
    first.
    """
    r = np.asarray(centre, dtype=np.float64)
    offset = np.asarray(half_height, dtype=np.float64)[:, None] * np.asarray(normal)
    return np.concatenate([r + offset, (r - offset)[::-1], (r + offset)[:1]])


def refine(frames: ArrayLike, between: int = 6) -> tuple[Array, Array]:
    """Interpolate the frames (m, 4, 4) of a rod, so that it is drawn smoothly.

    Returns k = between (m - 1) + 1 frames (k, 4, 4) on the cubic Hermite curve through the given
    ones, and their fractional indices (k,): 2.5 is halfway between the third and the fourth.
    """
    given = np.asarray(frames, dtype=np.float64)
    last = len(given) - 1
    station: Array = np.linspace(0.0, last, between * last + 1)
    i = np.minimum(station.astype(np.intp), last - 1)
    t = (station - i)[:, None]
    r, along = given[:, :3, 3], given[:, :3, 0]
    chord = np.linalg.norm(r[i + 1] - r[i], axis=1)[:, None]
    fine = np.tile(np.eye(4), (len(station), 1, 1))
    fine[:, :3, 3] = (
        (1.0 + 2.0 * t) * (1.0 - t) ** 2 * r[i]
        + t**2 * (3.0 - 2.0 * t) * r[i + 1]
        + t * (1.0 - t) * ((1.0 - t) * along[i] - t * along[i + 1]) * chord
    )
    blend = (1.0 - t)[:, :, None] * given[i, :3, :3] + t[:, :, None] * given[i + 1, :3, :3]
    # Project the mean of two rotations back onto SO(3).
    u, _, v = np.linalg.svd(blend)
    fine[:, :3, :3] = u @ v
    return fine, station


def capsule(
    first: ArrayLike, second: ArrayLike, r_first: float, r_second: float, arc_points: int = 48
) -> Array:
    """Return the closed outline (k, 2) of a tapered capsule: the convex hull of two discs.

    The larger circle if one disc contains the other.
    """
    a, b = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    axis = b - a
    distance = float(np.hypot(*axis))
    if distance <= abs(r_first - r_second):
        centre, radius = (a, r_first) if r_first >= r_second else (b, r_second)
        around: Array = np.linspace(0.0, 2.0 * np.pi, 2 * arc_points)
        return np.asarray(centre + radius * _directions(around))
    heading = np.arctan2(axis[1], axis[0])
    # Angle from the axis to the contact points of the common tangents.
    touch = np.arccos((r_first - r_second) / distance)
    around_first = heading + np.linspace(touch, 2.0 * np.pi - touch, arc_points)
    around_second = heading + np.linspace(-touch, touch, arc_points)
    outline = np.concatenate(
        [a + r_first * _directions(around_first), b + r_second * _directions(around_second)]
    )
    return np.concatenate([outline, outline[:1]])


def tube(
    centre: ArrayLike, first: ArrayLike, second: ArrayLike, sides: int = 24
) -> tuple[Array, Array, Array]:
    """Return the surface swept by an ellipse along a curve (m, 3): x, y, z, each (m, sides + 1).

    The semi-axes of the ellipse are vectors (m, 3).
    """
    angle = np.linspace(0.0, 2.0 * np.pi, sides + 1)
    surface = (
        np.asarray(centre, dtype=np.float64)[:, None, :]
        + np.cos(angle)[None, :, None] * np.asarray(first)[:, None, :]
        + np.sin(angle)[None, :, None] * np.asarray(second)[:, None, :]
    )
    return surface[..., 0], surface[..., 1], surface[..., 2]


def _directions(angle: Array) -> Array:
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)
