"""The mesh of half an actuator: sections swept along x, closed by end caps, and its surfaces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from .sections import Array, Block, Section

Indices = NDArray[np.int64]
MERGED = 1e-7  # mm between nodes that are one


@dataclass(frozen=True)
class Mesh:
    """27-node hexahedra and 9-node faces; half of the body, with y = 0 its plane of symmetry.

    `points` (n, 3) [mm]; `cells` (m, 3, 3, 3) index them along x and the two directions of the
    section. Faces (k, 3, 3) have the body behind them: `cavity`, `outside` (root, tip and plane of
    symmetry excluded). `rings` (nx,) are the x of the planes of nodes, `ring` (n,) the plane of
    each node.
    """

    points: Array
    cells: Indices
    cavity: Indices
    outside: Indices
    ring: Indices
    rings: Array

    @property
    def root(self) -> Indices:
        """Nodes of the first plane."""
        return np.flatnonzero(self.ring == 0)

    @property
    def tip(self) -> Indices:
        """Nodes of the last plane."""
        return np.flatnonzero(self.ring == len(self.rings) - 1)


def graded(length: float, size: float, ends: Sequence[float]) -> Array:
    """Divide a length into elements: `ends`, from each end inwards, and between them `size`."""
    inner = length - 2.0 * sum(ends)
    count = max(1, round(inner / size))
    return np.array([*ends, *[inner / count] * count, *reversed(ends)])


def sweep(
    section: Section,
    sizes: Array,
    cap: float,
    scale: Callable[[Array], Array] = np.ones_like,
) -> Mesh:
    """Sweep a section along elements of the given sizes, with a cap before and behind (0: none).

    `scale` is the factor on y and z as a function of the distance from the chamber's start.
    """
    caps = [cap] if cap > 0.0 else []
    steps = np.array([*caps, *sizes, *caps])
    ends = np.concatenate(([0.0], np.cumsum(steps)))
    rings = np.sort(np.concatenate((ends, ends[:-1] + steps / 2)))
    plane, wall, filling = _merge(section.wall, section.filling)
    slices = np.arange(len(steps))
    closed = slices[: len(caps)].tolist() + slices[len(steps) - len(caps) :].tolist()

    count = len(plane)
    cells = np.concatenate(
        [_slice(wall, count, i) for i in slices] + [_slice(filling, count, i) for i in closed]
    )
    used, cells = np.unique(cells, return_inverse=True)
    ring = used // count
    factor = scale(np.clip(rings - cap, 0.0, sizes.sum()))[ring]
    points = np.column_stack((rings[ring], plane[used % count] * factor[:, None]))

    faces = _surface(cells)
    bore = np.isin(used % count, np.intersect1d(wall, filling))
    inside = (ring >= 2 * len(caps)) & (ring <= len(rings) - 1 - 2 * len(caps))
    lid = np.isin(used % count, filling) & (
        (ring == 2 * len(caps)) | (ring == len(rings) - 1 - 2 * len(caps))
    )
    cavity = ((bore & inside) | lid)[faces].all(axis=(1, 2))
    symmetric = (np.abs(points[:, 1]) < MERGED)[faces].all(axis=(1, 2))
    flat = np.ptp(ring[faces], axis=(1, 2)) == 0
    return Mesh(
        points=points,
        cells=cells,
        cavity=faces[cavity & ~symmetric],
        outside=faces[~cavity & ~symmetric & ~flat],
        ring=ring,
        rings=rings,
    )


def _merge(wall: tuple[Block, ...], filling: tuple[Block, ...]) -> tuple[Array, Indices, Indices]:
    """Return the nodes of a section and the quadrilaterals (n, 3, 3) of wall and filling."""
    blocks = (*wall, *filling)
    points = np.concatenate([block.points.reshape(-1, 2) for block in blocks])
    _, first, index = np.unique(
        np.round(points / MERGED).astype(int), axis=0, return_index=True, return_inverse=True
    )
    starts = np.cumsum([0, *[block.points[..., 0].size for block in blocks]])
    quads = [
        _patches(index[a:b].reshape(block.points.shape[:2]), 2)
        for block, (a, b) in zip(blocks, pairwise(starts), strict=True)
    ]
    return points[first], np.concatenate(quads[: len(wall)]), np.concatenate(quads[len(wall) :])


def _patches(lattice: Indices, step: int) -> Indices:
    windows = np.lib.stride_tricks.sliding_window_view(lattice, (3, 3))
    return windows[::step, ::step].reshape(-1, 3, 3)


def _slice(quads: Indices, count: int, index: int) -> Indices:
    rings = (2 * index + np.arange(3))[None, :, None, None]
    return rings * count + quads[:, None]


def _surface(cells: Indices) -> Indices:
    """Return the faces that belong to one cell only, with outward normals."""
    faces = np.concatenate(
        [
            cells[:, 0].transpose(0, 2, 1),
            cells[:, 2],
            cells[:, :, 0],
            cells[:, :, 2].transpose(0, 2, 1),
            cells[..., 0].transpose(0, 2, 1),
            cells[..., 2],
        ]
    )
    # A face is known by its middle node.
    _, index, times = np.unique(faces[:, 1, 1], return_index=True, return_counts=True)
    return faces[index[times == 1]]
