"""Rotation matrices from the notations of MJCF and URDF, and back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexor.arrays import Array

TINY = 1e-12


def about(axis: Sequence[float] | Array, angle: float) -> Array:
    """Return the rotation (3, 3) about an axis of any length, by Rodrigues' formula."""
    x, y, z = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross)


def from_quaternion(quaternion: Array) -> Array:
    """Return the rotation of a quaternion (4,), the scalar first, of any length."""
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )


def from_euler(angles: Array, sequence: str) -> Array:
    """Return the rotation of three angles [rad]: about moving axes x, y, z, or fixed ones X, Y, Z.

    The letters are in the order of the angles.
    """
    found = np.eye(3)
    for angle, letter in zip(angles.tolist(), sequence, strict=True):
        turn = about(np.eye(3)["xyz".index(letter.lower())], angle)
        found = found @ turn if letter.islower() else turn @ found
    return found


def from_axes(x: Array, y: Array) -> Array | None:
    """Return the rotation with the x axis along one vector and the y axis in the plane of both."""
    if np.linalg.norm(np.cross(x, y)) < TINY:
        return None
    first = x / np.linalg.norm(x)
    second = y - (y @ first) * first
    second = second / np.linalg.norm(second)
    return np.column_stack([first, second, np.cross(first, second)])


def from_z(axis: Array) -> Array | None:
    """Return the least rotation that turns z to an axis."""
    size = float(np.linalg.norm(axis))
    if size < TINY:
        return None
    across = np.cross([0.0, 0.0, 1.0], axis / size)
    sine, cosine = float(np.linalg.norm(across)), float(axis[2]) / size
    if sine < TINY:
        return np.eye(3) if cosine > 0.0 else np.diag([1.0, -1.0, -1.0])
    return about(across, float(np.arctan2(sine, cosine)))


def rotation_vector(turn: Array) -> Array:
    """Return the rotation vector (3,) of a rotation [rad], of at most half a turn."""
    trace = float(np.trace(turn))
    # The largest component of the quaternion loses no digits.
    largest = np.array([trace, *np.diag(turn)])
    i = int(np.argmax(largest))
    if i == 0:
        q = np.array(
            [1.0 + trace, turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
        )
    else:
        a = i - 1
        b, c = (a + 1) % 3, (a + 2) % 3
        q = np.zeros(4)
        q[0] = turn[c, b] - turn[b, c]
        q[1 + a] = 1.0 + turn[a, a] - turn[b, b] - turn[c, c]
        q[1 + b] = turn[b, a] + turn[a, b]
        q[1 + c] = turn[c, a] + turn[a, c]
    q = q / np.linalg.norm(q)
    q = -q if q[0] < 0.0 else q
    sine = float(np.linalg.norm(q[1:]))
    if sine < 1e-16:
        return np.zeros(3)
    return np.asarray(q[1:] / sine * 2.0 * np.arctan2(sine, q[0]))
