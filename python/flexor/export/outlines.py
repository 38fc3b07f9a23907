"""Outlines of sections along a rod, as polygons: of the material outside, and of the cavities.

They are the union of the shapes that the mechanics integrates over (`flexor.sections`). Shapes keep
their corners all along a piece of the rod, so that the union is formed once, at one place, and
its corners are followed from there; where parts come apart that shows as a change of area.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.export.device import MM, Device
from flexor.export.extra import required
from flexor.model.schema.section_geometry import section_at, varies
from flexor.sections import Geometry, Rectangle, Sector

AROUND = 96  # corners of a circle: 0.07 % less than its area
STATIONS = 64  # along a rod whose surface is not linear
_NEAR = 1e-4  # of two corners [mm]
_SAME = 1e-6  # of two areas


@dataclass(frozen=True, eq=False)
class Segment:
    """A piece of the rod, cut at k stations.

    Attributes
    ----------
    x : (k,) array
        Stations [mm] from the base.
    outer : (k, m, 2) array
        Corners (y, z) of the outline [mm], counter-clockwise seen from the tip.
    cavities : dict of (k, m, 2) arrays
        Those of each cavity, likewise; `void…` for hollows that the model does not name.
    """

    x: Array
    outer: Array
    cavities: dict[str, Array]

    def between(self, points: Array, low: float, high: float) -> tuple[Array, Array]:
        """Return stations from `low` to `high` [mm] and the corners of an outline there."""
        inside = (self.x > low + 1e-9) & (self.x < high - 1e-9)
        at = np.concatenate([[low], self.x[inside], [high]])
        return at, self.at(points, at)

    def at(self, points: Array, x: Array) -> Array:
        """Return the corners of an outline at places x (n,) [mm], (n, m, 2)."""
        row = np.clip(np.searchsorted(self.x, x, side="right") - 1, 0, len(self.x) - 2)
        share = ((x - self.x[row]) / (self.x[row + 1] - self.x[row]))[:, None, None]
        return np.asarray(points[row] * (1.0 - share) + points[row + 1] * share)


def segments(device: Device, scale: float = 1.0) -> list[Segment]:
    """Return the outlines of a device, a segment for each of its sections.

    Parameters
    ----------
    device
        The device.
    scale
        By which it is enlarged.

    Raises
    ------
    InputError
        If a section cannot be made in one piece.
    """
    rod, found = device.rod, []
    low = 0.0
    for index, piece in enumerate(rod.pieces):
        high = 1.0 if piece.span is None else piece.span[1]
        straight = device.linear and not varies(piece)
        count = 2 if straight else max(2, round(STATIONS * (high - low))) + 1
        stations = np.linspace(low, high, count)
        several = len(rod.pieces) > 1
        place = f"{device.name}.section[{index}]" if several else f"{device.name}.section"
        outer, cavities = _followed(device, index, stations, place)
        size = MM * scale
        found.append(
            Segment(
                size * device.length * stations,
                size * outer,
                {name: size * points for name, points in cavities.items()},
            )
        )
        low = high
    return found


def _followed(
    device: Device, piece: int, stations: Array, place: str
) -> tuple[Array, dict[str, Array]]:
    """Return the outer outline and those of cavities at all stations [m]."""
    sections = []
    for x in stations:
        geometry = section_at(device.rod, device.file.materials, piece, float(x))
        assert geometry is not None
        s = device.surface(float(x))
        try:
            if not s > 0.0:
                raise InputError(f"has S = {MM * s:.4g} mm")
            geometry.check(s)
        except InputError as error:
            raise InputError(f"{place} cannot be made at X = {x:.3g}: {error}.") from None
        sections.append((geometry, s))
    middle = sections[len(sections) // 2]
    contours = _united(*middle, place, float(stations[len(sections) // 2]))
    corners = [np.concatenate(_contours(*section)) for section in sections]
    followed = [np.array([each[labels] for each in corners]) for labels in contours]
    for row, (geometry, s) in enumerate(sections):
        material = sum(area(c) for c in _contours(geometry, s))
        if abs(sum(area(points[row]) for points in followed) - material) > _SAME * material:
            raise InputError(
                f"{place} cannot be made in one piece: its parts come apart near "
                f"X = {stations[row]:.3g}."
            )
    outer, *holes = followed
    return outer, _named(holes, [g for g, _ in sections], [s for _, s in sections], place)


def _united(geometry: Geometry, s: float, place: str, x: float) -> list[Array]:
    """Return which corners of the shapes make up each contour of their union, the outer first."""
    manifold = required("manifold3d")
    shapes = _contours(geometry, s)
    corners = MM * np.concatenate(shapes)
    union = manifold.CrossSection([MM * each for each in shapes], manifold.FillRule.Positive)
    contours = []
    for polygon in union.to_polygons():
        distance = np.linalg.norm(polygon[:, None, :] - corners[None], axis=2)
        nearest = distance.argmin(axis=1)
        if distance[np.arange(len(polygon)), nearest].max() > _NEAR:
            raise InputError(f"{place} cannot be made: its parts overlap at X = {x:.3g}.")
        contours.append((area(polygon), nearest))
    outside = [labels for size, labels in contours if size > 0.0]
    if len(outside) != 1:
        raise InputError(
            f"{place} cannot be made in one piece: at X = {x:.3g} it has {len(outside)} parts that "
            "do not touch one another."
        )
    return [*outside, *(labels for size, labels in contours if size < 0.0)]


def _named(
    holes: list[Array], geometries: list[Geometry], surfaces: list[float], place: str
) -> dict[str, Array]:
    """Return the holes in the material by the name of their cavity, counter-clockwise."""
    found: dict[str, Array] = {}
    left = [hole[:, ::-1] for hole in holes]
    middle = len(surfaces) // 2
    geometry, s = geometries[middle], surfaces[middle]
    for name, cavity in geometry.cavities.items():
        shapes = [each for shape in cavity.shapes for each in polygons(shape, s)]
        size = sum(area(each) for each in shapes)
        centre = np.mean(np.concatenate(shapes), axis=0)
        for index, hole in enumerate(left):
            near = np.linalg.norm(hole[middle].mean(axis=0) - centre) < 0.5 * np.sqrt(abs(size))
            if near and abs(area(hole[middle]) - size) < _SAME * abs(size):
                found[name] = left.pop(index)
                break
        else:
            raise InputError(
                f'{place} cannot be made: the cavity "{name}" is not filled up to material all '
                "around it."
            )
    return found | {f"void-{index + 1}": hole for index, hole in enumerate(left)}


def _contours(geometry: Geometry, s: float) -> list[Array]:
    parts = [part.shape for part in geometry.parts if not (part.stiffening or part.applied)]
    return [each for shape in parts for each in polygons(shape, s)]


def polygons(shape: Rectangle | Sector, s: float) -> list[Array]:
    """Return the contours (m, 2) of a shape where the surface is at S = `s`.

    Counter-clockwise, holes clockwise, in the unit of `s`.
    """
    middle = np.array([shape.y.at(s), shape.z.at(s)])
    if isinstance(shape, Rectangle):
        half = 0.5 * np.array([shape.width.at(s), shape.height.at(s)])
        return [middle + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])]
    angle = np.linspace(0.0, pi, AROUND // 2 + 1) if shape.half else _CIRCLE
    direction = np.stack([shape.ratio * np.cos(angle), np.sin(angle)], axis=1)
    outer = middle + shape.outer.at(s) * direction
    inner = shape.inner.at(s)
    if not inner > 0.0:
        return [outer]
    hole = (middle + inner * direction)[::-1]
    return [np.concatenate([outer, hole])] if shape.half else [outer, hole]


_CIRCLE = 2.0 * pi * np.arange(AROUND) / AROUND


def area(polygon: Array) -> float:
    """Area of a polygon (m, 2), positive if counter-clockwise."""
    after = np.roll(polygon, -1, axis=0)
    return float(0.5 * np.sum(polygon[:, 0] * after[:, 1] - after[:, 0] * polygon[:, 1]))
