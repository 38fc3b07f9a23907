"""Rods cut lengthwise in their plane: walls, layers and cavities as they are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema.section_geometry import Materials, along, is_made_of_fibres
from flexor.plot.scene import Band
from flexor.sections import Geometry
from flexor.sections.outline import outline
from flexor.sections.shapes import Shape

if TYPE_CHECKING:
    from flexor.model.schema import Rod

CAVITY = "cavity"


def bands(rod: Rod, materials: Materials, x: Array, surface: Array) -> list[Band]:
    """Return the parts and cavities of a rod where its plane y = 0 cuts them.

    Parameters
    ----------
    rod
        The rod.
    materials
        The materials of the file.
    x : (m,) array
        Stations along it, X in [0, 1].
    surface : (m,) array
        S there [m].

    Returns
    -------
    list of Band
        None for a rod that is given by its stiffness.
    """
    if not is_made_of_fibres(rod):
        return []
    found: dict[tuple[int, str, int, int], Array] = {}
    for place, piece in enumerate(rod.pieces):
        first, last = piece.span or (0.0, 1.0)
        rows = np.flatnonzero((x >= first - 1e-9) & (x <= last + 1e-9))
        for group, geometry in along(rod, materials, place, x[rows]):
            here = rows[group]
            for (name, which), shape in _named(geometry).items():
                for index, ends in enumerate(_cut(shape, surface[here])):
                    key = place, name, which, index
                    table = found.setdefault(key, np.full((2, len(x)), np.nan))
                    table[:, here] = ends
    return [Band(name, low, high) for (_, name, _, _), (low, high) in found.items()]


def _named(geometry: Geometry | None) -> Mapping[tuple[str, int], Shape]:
    """Return the shapes of a section by their material, or as cavities."""
    if geometry is None:
        return {}
    parts = [(part.material, part.shape) for part in geometry.parts if not part.stiffening]
    hollow = [(CAVITY, each) for cavity in geometry.cavities.values() for each in cavity.shapes]
    return {(name, i): shape for i, (name, shape) in enumerate([*parts, *hollow])}


def _cut(shape: Shape, surface: Array) -> Iterator[Array]:
    """Yield where y = 0 enters and leaves a shape, (2, m) [m]."""
    shown = outline(shape, surface)
    first, second = shown.points[:, shown.edges].transpose(2, 0, 1, 3)  # each (m, e, 2)
    crosses = ((first[..., 0] > 0.0) != (second[..., 0] > 0.0)).all(axis=0)
    a, b = first[:, crosses], second[:, crosses]
    share = a[..., 0] / (a[..., 0] - b[..., 0])
    z = np.sort(a[..., 1] + share * (b[..., 1] - a[..., 1]), axis=1)
    for i in range(0, z.shape[1] - 1, 2):
        yield z[:, i : i + 2].T
