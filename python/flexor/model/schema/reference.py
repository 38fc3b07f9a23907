"""Poses of bodies in the reference state, in which all coordinates are zero."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from flexor.arrays import Array
from flexor.model.schema.body import Body, Rod
from flexor.model.schema.profile import surface


def reference_frames(bodies: Mapping[str, Body]) -> dict[str, Callable[[float], Array]]:
    """Return the frame along each body as a function of the fraction of its length.

    Parameters
    ----------
    bodies
        A tree of bodies.

    Returns
    -------
    dict
        Functions that return a homogeneous matrix, (4, 4).
    """
    frames: dict[str, Callable[[float], Array]] = {}

    def along(name: str) -> Callable[[float], Array]:
        if name not in frames:
            body = bodies[name]
            base = np.eye(4) if body.parent is None else along(body.parent)(1.0)
            frames[name] = _along(body, base @ _placement(body))
        return frames[name]

    for name in bodies:
        along(name)
    return frames


def _along(body: Body, base: Array) -> Callable[[float], Array]:
    strain = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0])
    if isinstance(body, Rod):
        names = ("twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z")
        strain = np.array([float(getattr(body.reference_strain, name)) for name in names])
    length = float(body.length)
    return lambda fraction: np.asarray(base @ _exponential(strain * length * fraction))


def _placement(body: Body) -> Array:
    place = body.placement
    frame = _exponential(np.array([*place.rotation.components, 0.0, 0.0, 0.0]))
    frame[:3, 3] = [place.x, place.y, place.z]
    if isinstance(body, Rod) and place.reference == "underside":
        frame[:3, 3] += surface(body.radius, np.zeros(1))[0][0] * place.dorsal
    return frame


def _exponential(twist: Array) -> Array:
    """Return the exponential (4, 4) of a twist (6,) in closed form.

    Murray, Li and Sastry (1994), A Mathematical Introduction to Robotic Manipulation, chapter 2.
    """
    x, y, z = twist[:3].tolist()
    found = np.eye(4)
    if not (x or y or z):
        found[:3, 3] = twist[3:]
        return found
    turn = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    square = turn @ turn
    angle = math.sqrt(x * x + y * y + z * z)
    first, half = math.sin(angle) / angle, math.sin(0.5 * angle) / angle
    second, third = 2.0 * half * half, _third(angle)
    found[:3, :3] += first * turn + second * square
    found[:3, 3] = twist[3:] + (second * turn + third * square) @ twist[3:]
    return found


def _third(angle: float) -> float:
    """Return (θ - sin θ) / θ³, by its series where the difference would cancel."""
    if angle > 1.0:
        return (angle - math.sin(angle)) / angle**3
    square, term, total = angle * angle, 1.0 / 6.0, 0.0
    for k in range(9):
        total += term
        term *= -square / ((2 * k + 4) * (2 * k + 5))
    return total
