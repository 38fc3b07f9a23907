"""Cross-sections as blocks of quadrilaterals: half of each, y >= 0, with the filling of its cavity.

x runs along the actuator, y across, z from the strain-limiting layer upwards. Lengths in mm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Block:
    """A structured patch of (rows - 1)/2 by (columns - 1)/2 biquadratic quadrilaterals.

    `points` (rows, columns, 2) are y and z; rows and columns are right-handed in the y-z plane.
    """

    points: Array


@dataclass(frozen=True)
class Section:
    """The wall and the filling of its cavity, which only the end caps have."""

    wall: tuple[Block, ...]
    filling: tuple[Block, ...]


@dataclass(frozen=True)
class Fineness:
    """Elements through a wall, along an eighth of a circle and from a core to the bore.

    `slice` is the length of elements along x [mm].
    """

    wall: int
    octant: int
    radial: int
    slice: float


def _block(
    first: Callable[[Array], Array], second: Callable[[Array], Array], along: int, across: int
) -> Block:
    """Interpolate linearly between two curves of a parameter in [0, 1]."""
    s = np.linspace(0.0, 1.0, 2 * along + 1)
    t = np.linspace(0.0, 1.0, 2 * across + 1)[:, None, None]
    return _right_handed((1.0 - t) * first(s) + t * second(s))


def _right_handed(points: Array) -> Block:
    u, v = points[1, 0] - points[0, 0], points[0, 1] - points[0, 0]
    return Block(points if u[0] * v[1] > u[1] * v[0] else points.transpose(1, 0, 2))


def _line(y0: float, z0: float, y1: float, z1: float) -> Callable[[Array], Array]:
    a, b = np.array((y0, z0)), np.array((y1, z1))
    return lambda s: a + s[:, None] * (b - a)


def _arc(radius: float, start: float, end: float, z: float) -> Callable[[Array], Array]:
    def curve(s: Array) -> Array:
        angle = np.radians(start + s * (end - start))
        return np.column_stack((radius * np.cos(angle), z + radius * np.sin(angle)))

    return curve


def _rectangle(y: tuple[float, float], z: tuple[float, float], nodes: tuple[int, int]) -> Block:
    return _block(_line(y[0], z[0], y[1], z[0]), _line(y[0], z[1], y[1], z[1]), *nodes)


CORE = 0.55  # side of the square in a quarter of a disc, of its radius


def _quarter(radius: float, z: float, mesh: Fineness, up: float) -> tuple[Block, ...]:
    """Fill a quarter of a disc, above (`up` = 1) or below its centre: a core and two patches."""
    c, d = CORE * radius, 0.85 * CORE * radius
    k, r = mesh.octant, mesh.radial
    return (
        _block(_line(0, z, c, z), _line(0, z + up * c, d, z + up * d), k, k),
        _block(_line(c, z, d, z + up * d), _arc(radius, 0, up * 45, z), k, r),
        _block(_line(d, z + up * d, 0, z + up * c), _arc(radius, up * 45, up * 90, z), k, r),
    )


def half_round(radius: float, wall: float, floor: float, mesh: Fineness) -> Section:
    """Return a half-disc bore of a radius under a round wall, on a flat floor."""
    a, t, outer = radius, mesh.wall, radius + wall
    flat = (0.0, floor)
    return Section(
        wall=(
            _rectangle((0, CORE * a), flat, (mesh.octant, t)),
            _rectangle((CORE * a, a), flat, (mesh.radial, t)),
            _rectangle((a, outer), flat, (t, t)),
            _block(_arc(a, 0, 90, floor), _arc(outer, 0, 90, floor), 2 * mesh.octant, t),
        ),
        filling=_quarter(a, floor, mesh, 1.0),
    )


def tube(radius: float, wall: float, mesh: Fineness) -> Section:
    """Return a round bore of a radius in a round wall; z = 0 is the axis."""
    arcs = _arc(radius, -90, 90, 0), _arc(radius + wall, -90, 90, 0)
    return Section(
        wall=(_block(*arcs, 4 * mesh.octant, mesh.wall),),
        filling=_quarter(radius, 0, mesh, 1.0) + _quarter(radius, 0, mesh, -1.0),
    )


def box(width: float, height: float, wall: float, floor: float, mesh: Fineness) -> Section:
    """Return a rectangular bore under a wall, on a floor."""
    half, t, n, m = width / 2, mesh.wall, 2 * mesh.octant, 2 * mesh.octant
    y, side = (0.0, half), (half, half + wall)
    low, bore, top = (0.0, floor), (floor, floor + height), (floor + height, floor + height + wall)
    return Section(
        wall=(
            _rectangle(y, low, (n, t)),
            _rectangle(side, low, (t, t)),
            _rectangle(side, bore, (t, m)),
            _rectangle(side, top, (t, t)),
            _rectangle(y, top, (n, t)),
        ),
        filling=(_rectangle(y, bore, (n, m)),),
    )
