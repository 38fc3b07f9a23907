"""Outlines of the shapes of a cross-section, for drawing and for solids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array
from flexor.sections.linear import ZERO, Linear
from flexor.sections.shapes import Rectangle, Sector, Shape

# Points along a half-circle, and along a side.
ARC, SIDE = 24, 6


@dataclass(frozen=True)
class Outline:
    """The closed boundary of a shape in n points, at m places along a rod.

    Attributes
    ----------
    points : (m, n, 2) array
        y and z [m]. Corners are two points, so that surfaces through the edges are smooth and meet
        in sharp corners.
    edges : (e, 2) array
        Pairs of points with the material on their left, seen against the rod's x axis.
    triangles : (t, 3) array
        The area, counter-clockwise seen against the rod's x axis.
    """

    points: Array
    edges: NDArray[np.intp]
    triangles: NDArray[np.intp]


def outline(shape: Shape, s: Array) -> Outline:
    """Return the outline of a shape.

    Parameters
    ----------
    shape
        The shape.
    s : (m,) array
        The surface S at m places [m].
    """
    if isinstance(shape, Rectangle):
        return _rectangle(shape, s)
    hollow = shape.inner != ZERO
    if shape.half:
        return _half_ring(shape, s) if hollow else _half_disc(shape, s)
    return _ring(shape, s) if hollow else _disc(shape, s)


def _rectangle(shape: Rectangle, s: Array) -> Outline:
    step = np.linspace(-0.5, 0.5, SIDE + 1)
    half = np.full(SIDE + 1, 0.5)
    y = np.concatenate([step, half, -step, -half])
    z = np.concatenate([-half, step, half, -step])
    points = np.stack(
        [
            _at(shape.y, s)[:, None] + _at(shape.width, s)[:, None] * y,
            _at(shape.z, s)[:, None] + _at(shape.height, s)[:, None] * z,
        ],
        axis=2,
    )
    sides = [_open(SIDE + 1, SIDE * k + k) for k in range(4)]
    return Outline(points, np.concatenate(sides), _fan(len(y)))


def _disc(shape: Sector, s: Array) -> Outline:
    angle = np.linspace(0.0, 2.0 * np.pi, 2 * ARC, endpoint=False)
    points = _circle(shape, _at(shape.outer, s), angle, s)
    return Outline(points, _closed(len(angle)), _fan(len(angle)))


def _ring(shape: Sector, s: Array) -> Outline:
    angle = np.linspace(0.0, 2.0 * np.pi, 2 * ARC, endpoint=False)
    outer, inner = (
        _circle(shape, _at(radius, s), angle, s) for radius in (shape.outer, shape.inner)
    )
    n = len(angle)
    here = np.arange(n)
    after = (here + 1) % n
    strip = [np.stack([here, after, n + after], 1), np.stack([here, n + after, n + here], 1)]
    edges = np.concatenate([_closed(n), n + _closed(n)[:, ::-1]])
    return Outline(np.concatenate([outer, inner], axis=1), edges, np.concatenate(strip))


def _half_disc(shape: Sector, s: Array) -> Outline:
    arc = _circle(shape, _at(shape.outer, s), np.linspace(0.0, np.pi, ARC + 1), s)
    points = np.concatenate([arc, arc[:, [-1, 0]]], axis=1)
    edges = np.concatenate([_open(ARC + 1), _open(2, ARC + 1)])
    return Outline(points, edges, _fan(ARC + 1))


def _half_ring(shape: Sector, s: Array) -> Outline:
    angle = np.linspace(0.0, np.pi, ARC + 1)
    outer = _circle(shape, _at(shape.outer, s), angle, s)
    inner = _circle(shape, _at(shape.inner, s), angle[::-1], s)
    n = ARC + 1
    feet = np.stack([outer[:, -1], inner[:, 0], inner[:, -1], outer[:, 0]], axis=1)
    here = np.arange(n - 1)
    far = 2 * n - 1 - here  # of the inner arc, beside each point of the outer
    strip = [np.stack([here, here + 1, far - 1], 1), np.stack([here, far - 1, far], 1)]
    edges = [_open(n), _open(n, n), _open(2, 2 * n), _open(2, 2 * n + 2)]
    points = np.concatenate([outer, inner, feet], axis=1)
    return Outline(points, np.concatenate(edges), np.concatenate(strip))


def _circle(shape: Sector, radius: Array, angle: Array, s: Array) -> Array:
    y = _at(shape.y, s)[:, None] + shape.ratio * radius[:, None] * np.cos(angle)
    return np.stack([y, _at(shape.z, s)[:, None] + radius[:, None] * np.sin(angle)], axis=2)


def _at(length: Linear, s: Array) -> Array:
    return np.broadcast_to(length.at(s), s.shape)


def _open(count: int, first: int = 0) -> NDArray[np.intp]:
    here = first + np.arange(count - 1)
    return np.stack([here, here + 1], axis=1)


def _closed(count: int) -> NDArray[np.intp]:
    here = np.arange(count)
    return np.stack([here, (here + 1) % count], axis=1)


def _fan(count: int) -> NDArray[np.intp]:
    here = np.arange(1, count - 1)
    return np.stack([np.zeros_like(here), here, here + 1], axis=1)
