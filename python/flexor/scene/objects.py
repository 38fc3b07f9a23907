"""Meshes of a scene, at every load step."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from flexor.arrays import Array

Kind = Literal[
    "rod",
    "link",
    "chamber",
    "line",
    "strap",
    "spring",
    "tie",
    "tendon",
    "wrap",
    "obstacle",
    "friction",
]


@dataclass(frozen=True, eq=False)
class Object:
    """A mesh of v vertices and f faces that moves over s load steps.

    Attributes
    ----------
    name : str
        Of the body, strap, spring, tendon, wrap, tie, actuator or obstacle; of marks what they
        mark.
    kind : str
        What it is.
    part : str
        The material or layer, such as ``"silicone"`` or ``"bone"``; may be empty.
    faces : (f, 3) array
        Triangles, counter-clockwise seen from outside.
    fields : dict of (s, v) arrays
        Scalar fields on its surface, SI; NaN where there is no value.
    """

    name: str
    kind: Kind
    part: str
    faces: NDArray[np.intp]
    fields: dict[str, Array] = field(default_factory=dict)

    def vertices(self, step: int = -1) -> Array:
        """Return the vertices in one step, (v, 3) [m]."""
        raise NotImplementedError

    @property
    def size(self) -> int:
        """Number of vertices."""
        raise NotImplementedError

    def volume(self, step: int = -1) -> float:
        """Return the enclosed volume in one step [m³], by the divergence theorem."""
        a, b, c = self.vertices(step)[self.faces].transpose(1, 0, 2)
        return float(np.einsum("fi,fi->", a, np.cross(b, c)) / 6.0)


@dataclass(frozen=True, eq=False)
class Attached(Object):
    """A mesh whose vertices are each fixed in one of m frames.

    Attributes
    ----------
    local : (v, 3) array
        Vertices in their frames [m].
    frame : (v,) array
        Which frame each is fixed in.
    frames : (s, m, 4, 4) array
        Homogeneous matrices of the frames.
    """

    local: Array = field(kw_only=True)
    frame: NDArray[np.intp] = field(kw_only=True)
    frames: Array = field(kw_only=True)

    @property
    def size(self) -> int:
        """Number of vertices."""
        return len(self.local)

    def vertices(self, step: int = -1) -> Array:
        """Return the vertices in one step, (v, 3) [m]."""
        at = self.frames[step][self.frame]
        return np.asarray(np.einsum("vij,vj->vi", at[:, :3, :3], self.local) + at[:, :3, 3])

    def sampled(self, every: int) -> Array:
        """Return some of the vertices at all steps, (s, v / every, 3) [m]."""
        local, at = self.local[::every], self.frames[:, self.frame[::every]]
        return np.asarray((at[..., :3, :3] @ local[:, :, None])[..., 0] + at[..., :3, 3])


@dataclass(frozen=True, eq=False)
class Free(Object):
    """A mesh whose vertices are given at each step.

    Attributes
    ----------
    positions : (s, v, 3) array
        Vertices [m].
    """

    positions: Array = field(kw_only=True)

    @property
    def size(self) -> int:
        """Number of vertices."""
        return int(self.positions.shape[1])

    def vertices(self, step: int = -1) -> Array:
        """Return the vertices in one step, (v, 3) [m]."""
        return np.asarray(self.positions[step])


def grid_faces(rows: int, columns: int, closed: bool = False) -> NDArray[np.intp]:
    """Return the triangles of a grid of vertices, row by row.

    They are counter-clockwise where columns run to the right and rows upwards; of a closed grid the
    last column joins the first.
    """
    across = np.arange(columns if closed else columns - 1)
    k, i = np.meshgrid(np.arange(rows - 1), across, indexing="ij")
    j = (i + 1) % columns
    a, b, c, d = k * columns + i, k * columns + j, (k + 1) * columns + j, (k + 1) * columns + i
    return np.stack([a, b, c, a, c, d], axis=2).reshape(-1, 3)
