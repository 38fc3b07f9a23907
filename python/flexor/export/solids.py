"""Solids in millimetres, by manifold3d."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.export.extra import required

Solid = Any  # manifold3d.Manifold
_SLIVER = 1e-3  # [mm³]


def loft(x: Array, outlines: Array) -> Solid:
    """Return the solid through polygons across the x axis.

    Parameters
    ----------
    x : (k,) array
        Their places, increasing [mm].
    outlines : (k, m, 2) array
        Their corners (y, z), counter-clockwise [mm].
    """
    manifold = required("manifold3d")
    k, m = outlines.shape[:2]
    points = np.empty((k, m, 3))
    points[:, :, 0] = x[:, None]
    points[:, :, 1:] = outlines
    i, j = np.meshgrid(np.arange(k - 1) * m, np.arange(m), indexing="ij")
    a, b = i + j, i + (j + 1) % m
    sides = [np.stack([a, b, b + m], axis=-1), np.stack([a, b + m, a + m], axis=-1)]
    ends = [np.asarray(manifold.triangulate([outlines[row]]), dtype=np.int64) for row in (0, k - 1)]
    triangles = [each.reshape(-1, 3) for each in sides]
    triangles += [ends[0][:, ::-1], ends[1] + (k - 1) * m]
    mesh = manifold.Mesh64(
        vert_properties=points.reshape(-1, 3),
        tri_verts=np.concatenate(triangles).astype(np.uint64),
    )
    return manifold.Manifold(mesh)


def extruded(outline: Array, low: float, high: float) -> Solid:
    """Return the prism of a polygon (m, 2) from x = `low` to `high` [mm]."""
    return loft(np.array([low, high]), np.array([outline, outline]))


def rectangle(y: tuple[float, float], z: tuple[float, float]) -> Array:
    """Return a rectangle, counter-clockwise; shape (4, 2)."""
    return np.array([[y[0], z[0]], [y[1], z[0]], [y[1], z[1]], [y[0], z[1]]])


def box(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]) -> Solid:
    """Return a box [mm]."""
    return extruded(rectangle(y, z), *x)


def cone(
    base: tuple[float, float, float], axis: str, height: float, radii: tuple[float, float]
) -> Solid:
    """Return a cone from its base along an axis, `"x"`, `"y"` or `"z"`, or `"-x"` and so on [mm].

    `radii` are those at its base and at its end.
    """
    manifold = required("manifold3d")
    made = manifold.Manifold.cylinder(height, radii[0], radii[1], 48)
    turn = {
        "z": (0.0, 0.0, 0.0),
        "-z": (180.0, 0.0, 0.0),
        "x": (0.0, 90.0, 0.0),
        "-x": (0.0, -90.0, 0.0),
        "y": (-90.0, 0.0, 0.0),
        "-y": (90.0, 0.0, 0.0),
    }[axis]
    return made.rotate(turn).translate(base)


def united(solids: list[Solid]) -> Solid:
    """Return the union of solids."""
    manifold = required("manifold3d")
    return manifold.Manifold.batch_boolean(solids, manifold.OpType.Add)


def cleaned(solid: Solid, what: str) -> Solid:
    """Return a solid without the slivers that coinciding faces leave.

    Raises
    ------
    InputError
        If it is in several pieces.
    """
    pieces = [each for each in solid.decompose() if each.volume() > _SLIVER]
    if len(pieces) != 1:
        raise InputError(f"{what} cannot be made: it would be in {len(pieces)} pieces.")
    return pieces[0]


def grown(outlines: list[Array], by: float) -> Array:
    """Return the outline (m, 2) around polygons that overlap, moved outwards [mm]."""
    manifold = required("manifold3d")
    shape = manifold.CrossSection(outlines, manifold.FillRule.Positive)
    moved = shape.offset(by, manifold.JoinType.Miter, 2.0, 0).simplify(1e-3)
    return np.asarray(max(moved.to_polygons(), key=len))


def triangles(solid: Solid) -> tuple[Array, Any]:
    """Return corners (n, 3) [mm] and triangles (t, 3) of a solid."""
    mesh = solid.to_mesh64()
    return np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts).astype(np.int64)
