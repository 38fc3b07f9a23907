"""What is cut from fabric: layers that limit strain, and straps, as flat outlines in a DXF file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import acos, atan2, hypot, pi, sqrt
from pathlib import Path

import numpy as np

from flexor.arrays import Array
from flexor.export.body import Body
from flexor.export.device import MM
from flexor.export.extra import required
from flexor.model.schema import Link
from flexor.model.schema.section_geometry import section_at
from flexor.model.schema.strap import Loop, Strap
from flexor.sections import Rectangle
from flexor.sections.shapes import moments

_GAP = 10.0  # between pieces on a sheet [mm]


@dataclass(frozen=True, eq=False)
class Sheet:
    """A flat piece.

    Attributes
    ----------
    name : str
        What it is.
    material : str
        Of what.
    contours : list of (m, 2) arrays
        Its outline and its slots [mm].
    thickness : float
        [mm].
    applied : bool
        Whether it is bonded to the finished body, and not cast with it.
    """

    name: str
    material: str
    contours: list[Array]
    thickness: float
    applied: bool = False

    @property
    def size(self) -> Array:
        """Length and width [mm]."""
        return np.asarray(np.ptp(self.contours[0], axis=0))


def sheets(body: Body) -> list[Sheet]:
    """Return the layers and straps of a body.

    A layer is a flat part of a section, below an eighth as thick as wide, of another material than
    most of it. Its length is that along its middle, divided by its stretch; ears are part of it
    where it lies on the parting surface. A strap runs from ear to ear around the link.
    """
    return [*_layers(body), *_straps(body)]


def cast_material(body: Body) -> str:
    """Return the material that has most of the volume."""
    found = volumes(body)
    return max(found, key=lambda name: found[name])


@lru_cache(maxsize=8)
def volumes(body: Body) -> Mapping[str, float]:
    """Volume of each cast material by integrals of the sections, without caps and ears [m³]."""
    device, found = body.device, dict[str, float]()
    points, weights = np.polynomial.legendre.leggauss(24)
    for index, part in enumerate(body.parts):
        low, high = part.x[0] / body.length, part.x[-1] / body.length
        for node, weight in zip(points, weights, strict=True):
            x = float(low + (high - low) * 0.5 * (node + 1.0))
            geometry = section_at(device.rod, device.file.materials, index, x)
            assert geometry is not None
            s = device.surface(x)
            share = 0.5 * weight * (high - low) * device.length
            for each in geometry.parts:
                if not (each.stiffening or each.applied):
                    area = float(moments((each.shape,))[:3] @ (1.0, s, s * s))
                    found[each.material] = found.get(each.material, 0.0) + share * area
    return found


def _layers(body: Body) -> list[Sheet]:
    device, cast = body.device, cast_material(body)
    found: list[Sheet] = []
    for index, part in enumerate(body.parts):
        stations = np.linspace(part.x[0], part.x[-1], 65)
        sections = [
            section_at(device.rod, device.file.materials, index, float(x / body.length))
            for x in stations
        ]
        surfaces = [device.surface(float(x / body.length)) for x in stations]
        assert sections[0] is not None
        for number, own in enumerate(sections[0].parts):
            shapes = [each.parts[number].shape for each in sections if each is not None]
            if own.material == cast or not isinstance(own.shape, Rectangle) or own.stiffening:
                continue
            rows = [
                (MM * r.width.at(s), MM * r.height.at(s), MM * r.y.at(s), MM * r.z.at(s))
                for r, s in zip(shapes, surfaces, strict=True)
                if isinstance(r, Rectangle)
            ]
            width, height, y, z = np.array(rows).T
            if height.max() > 0.125 * width.min():
                continue
            outline = _developed(body, stations, (width, y, z, height), own.stretch)
            name = f"layer-{len(found) + 1}"
            found.append(Sheet(name, own.material, outline, float(height.mean()), own.applied))
    return found


def _developed(
    body: Body, x: Array, dimensions: tuple[Array, Array, Array, Array], stretch: float
) -> list[Array]:
    """Lay a layer out flat, with the ears that it lies in."""
    manifold = required("manifold3d")
    width, y, z, height = dimensions
    along = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(z)))]) / stretch
    outline = np.concatenate(
        [
            np.stack([along, y - 0.5 * width], axis=1),
            np.stack([along, y + 0.5 * width], axis=1)[::-1],
        ]
    )
    shape = manifold.CrossSection([outline], manifold.FillRule.Positive)
    for ear in body.ears:
        inside = x[0] <= 0.5 * (ear.x[0] + ear.x[1]) <= x[-1]
        underside = np.interp(0.5 * (ear.x[0] + ear.x[1]), x, z - 0.5 * height)
        if not inside or abs(underside - ear.z) > height.max():
            continue
        ends = np.interp(ear.x, x, along)
        shape += manifold.CrossSection([_rectangle(ends, ear.y)], manifold.FillRule.Positive)
        slot = np.interp(ear.slot_x, x, along)
        for side in (ear.slot_y, (-ear.slot_y[1], -ear.slot_y[0])):
            shape -= manifold.CrossSection([_rectangle(slot, side)], manifold.FillRule.Positive)
    contours = [np.asarray(each) for each in shape.to_polygons()]
    return sorted(contours, key=lambda each: -float(np.ptp(each[:, 0])))


def _straps(body: Body) -> list[Sheet]:
    found, options = [], body.options
    for ear in body.ears:
        strap = body.device.file.straps[ear.strap]
        width = MM * (options.strap if strap.width is None else float(strap.width))
        length = around(body, ear.strap) + 2.0 * MM * options.fold
        outline = _rectangle((0.0, length), (-0.5 * width, 0.5 * width))
        thickness = MM * options.strap_thickness
        found.append(Sheet(f"strap-{ear.strap}", "webbing", [outline], thickness))
    return found


def around(body: Body, name: str) -> float:
    """Return the length of a strap from slot to slot around its body, at rest [mm].

    It is tangent to the circle of the body's section.
    """
    file = body.device.file
    strap = file.straps[name]
    ear = next(each for each in body.ears if each.strap == name)
    radius, gap = MM * _radius(body, strap), MM * max(strap.distance(file), 0.0)
    surface = MM * body.device.surface(strap.at)
    height = radius + gap + ear.z + surface
    across = 0.5 * (ear.slot_y[0] + ear.slot_y[1])
    distance = hypot(height, across)
    if distance <= radius:  # the ears are within the outline of the link
        return 2.0 * pi * radius
    wrapped = 2.0 * pi - 2.0 * (atan2(across, height) + acos(radius / distance))
    return 2.0 * sqrt(distance**2 - radius**2) + radius * wrapped


def _radius(body: Body, strap: Strap) -> float:
    file = body.device.file
    to = file.bodies[strap.to.body]
    if not isinstance(to, Link):
        return float(np.mean([float(each) for each in np.ravel(_ends(to))]))
    at = 0.5 if isinstance(strap.to, Loop) else strap.fraction(file)
    return float(to.radius.base) + at * (float(to.radius.tip) - float(to.radius.base))


def _ends(rod: object) -> Array:
    from flexor.model.schema.profile import surface

    return surface(rod.radius, np.array([0.0, 1.0]))[0]  # type: ignore[attr-defined]


def _rectangle(x: Array | tuple[float, float], y: tuple[float, float]) -> Array:
    return np.array([[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]])


def write_dxf(pieces: list[Sheet], file: Path) -> None:
    """Write flat pieces below one another into a DXF file, in mm; each on its own layer."""
    ezdxf = required("ezdxf")
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = 4  # millimetres
    # Otherwise a random name and the time are in the file.
    document.header["$MEASUREMENT"] = 1
    space = document.modelspace()
    level = 0.0
    for piece in pieces:
        low = np.min(piece.contours[0], axis=0)
        high = np.max(piece.contours[0], axis=0)
        shift = np.array([-low[0], level - high[1]])
        document.layers.add(piece.name)
        for contour in piece.contours:
            points = (contour + shift).tolist()
            space.add_lwpolyline(points, close=True, dxfattribs={"layer": piece.name})
        level -= float(high[1] - low[1]) + _GAP
    document.saveas(file)
