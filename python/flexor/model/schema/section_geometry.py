"""Sections along a rod: from the tables to shapes, and to the engine's description."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor import sections
from flexor.arrays import Array
from flexor.errors import InputError, unknown_name
from flexor.model.schema.body import Rod
from flexor.model.schema.material import Material
from flexor.model.schema.profile import interpolated, surface
from flexor.model.schema.section import (
    Box,
    Composite,
    HalfRound,
    Hollow,
    Layer,
    Part,
    Section,
    Solid,
    Stiffness,
    Tube,
    materials_of,
)
from flexor.model.validation import field_error
from flexor.sections import Geometry, Linear

Materials = Mapping[str, Material]


def is_made_of_fibres(rod: Rod) -> bool:
    """Whether a rod's section is more than a solid shape of its own modulus."""
    return rod.material is not None or not isinstance(rod.section, Solid)


def gauss_points(rod: Rod) -> NDArray[np.intp]:
    """Return which sample points of a rod are Gauss points."""
    return rod.gauss_rule[0]


def check_section(rod: Rod, path: str, materials: Materials) -> None:
    """Check that a rod's section can be made of the materials there are.

    Parameters
    ----------
    rod
        The rod.
    path
        Dotted path of its table, for messages.
    materials
        The materials of the file.

    Raises
    ------
    PydanticCustomError
        Naming the field that is wrong.
    """
    if rod.material is not None and rod.material not in materials:
        raise field_error(_unknown(rod.material, materials), f"{path}.material")
    for key, name in materials_of(rod.section):
        if name is None and rod.material is None:
            if isinstance(rod.section, Solid):
                continue
            tail = "is missing: name one of [materials], here or as the rod's material"
            raise field_error(tail, f"{path}.section.{key}")
        if name is not None and name not in materials:
            raise field_error(_unknown(name, materials), f"{path}.section.{key}")
    if not is_made_of_fibres(rod) or isinstance(rod.section, Stiffness):
        return
    radius, _ = surface(rod.radius, rod.sample_points)
    points = gauss_points(rod)
    built = geometries(rod, materials)
    try:
        for index, point in enumerate(points):
            geometry = built[index % len(built)]
            geometry.check(float(radius[point]))
        if isinstance(rod.section, Composite):
            for s in {float(radius.min()), float(radius.max())}:
                built[0].check_parts(s, _part_names(rod.section))
    except InputError as error:
        raise field_error(f"cannot be made: {error}", f"{path}.section") from None


def _unknown(name: str, materials: Materials) -> str:
    return f"refers to the {unknown_name('material', name, materials)}"


def _part_names(section: Composite) -> dict[int, str]:
    order = [i for i, part in enumerate(section.parts) if part.cavity is None]
    order += [i for i, part in enumerate(section.parts) if part.cavity is not None]
    return {place: f"parts[{i}]" for place, i in enumerate(order)}


def geometries(rod: Rod, materials: Materials) -> list[Geometry]:
    """Return the section at each Gauss point, or once if its sizes vary with S only."""
    x = rod.sample_points[gauss_points(rod)]
    varies = any(isinstance(size, tuple) for size in _sizes(rod.section))
    return [_geometry(rod, materials, float(at)) for at in (x if varies else x[:1])]


def _sizes(section: Section) -> list[object]:
    tables = [section, getattr(section, "layer", None), *getattr(section, "parts", ())]
    names = ("wall", "floor", "width", "height", "radius", "thickness")
    return [getattr(table, name, None) for table in tables for name in names]


def _linear(size: Any, x: float) -> Linear:
    if isinstance(size, tuple):
        return Linear(float(interpolated(size, np.array([x]))[0][0]))
    return Linear(float(size)) if hasattr(size, "text") else Linear(0.0, float(size))


def _layer(layer: Layer | None, x: float) -> tuple[Linear, str, float] | None:
    return None if layer is None else (_linear(layer.thickness, x), layer.material, layer.stretch)


def _geometry(rod: Rod, materials: Materials, x: float) -> Geometry:
    section = rod.section
    if isinstance(section, Solid):
        assert rod.material is not None
        return sections.solid(section.kind, section.ratio or 1.0, rod.material)
    if isinstance(section, Composite):
        return _composite(section, rod, x)
    assert isinstance(section, Hollow)
    material = section.material or rod.material
    assert material is not None
    wall = _linear(section.wall, x)
    wound = materials[material].winding == "hoop"
    rest = (material, section.stretch, section.winding, wound)
    if isinstance(section, Tube):
        return sections.tube(wall, *rest)
    if isinstance(section, HalfRound):
        floor = _linear(section.floor, x)
        return sections.half_round(wall, floor, _layer(section.layer, x), *rest)
    assert isinstance(section, Box)
    floor = wall if section.floor is None else _linear(section.floor, x)
    width = _linear(section.width, x)
    return sections.box(width, wall, floor, _layer(section.layer, x), *rest)


def _composite(section: Composite, rod: Rod, x: float) -> Geometry:
    parts, cavities = [], {}
    for part in section.parts:
        shape = _shape(part, x)
        if part.cavity is not None:
            cavities[part.cavity] = shape
        else:
            material = part.material or rod.material
            assert material is not None
            parts.append(sections.Part(shape, material, part.stretch))
    return sections.composite(parts, cavities, None)


def _shape(part: Part, x: float) -> sections.Rectangle | sections.Sector:
    y, z = _linear(part.y, x), _linear(part.z, x)
    if part.shape == "rectangle":
        return sections.Rectangle(y, z, _linear(part.width, x), _linear(part.height, x))
    outer = _linear(part.radius, x)
    inner = Linear(0.0) if part.wall is None else outer - _linear(part.wall, x)
    return sections.Sector(y, z, inner, outer, half=part.shape.startswith("half"))


def half_width(rod: Rod, materials: Materials, radius: Array) -> Array:
    """Return half of the width of a rod, along y.

    Parameters
    ----------
    rod
        The rod.
    materials
        The materials of the file.
    radius : (n,) array
        S at points along it [m].
    """
    if isinstance(rod.section, Solid):
        return (rod.section.ratio or 1.0) * radius
    if isinstance(rod.section, Stiffness):
        return radius
    parts = geometries(rod, materials)[0].parts
    return np.array([max(part.shape.extent(float(s))[1] for part in parts) for s in radius])


def roundness(rod: Rod, materials: Materials) -> float:
    """Return S times the curvature of a rod's underside across; 0 where it is flat.

    Parameters
    ----------
    rod
        The rod.
    materials
        The materials of the file.
    """
    if isinstance(rod.section, Solid):
        ratio = rod.section.ratio or 1.0
        return 0.0 if rod.section.kind == "rectangular" else 1.0 / ratio**2
    if isinstance(rod.section, Stiffness):
        return 1.0
    s = float(surface(rod.radius, np.array([0.5]))[0][0])
    parts = geometries(rod, materials)[0].parts
    lowest = min((part.shape for part in parts), key=lambda shape: shape.extent(s)[2])
    if isinstance(lowest, sections.Rectangle) or lowest.half:
        return 0.0
    return s / lowest.outer.at(s)


def lower_fibres(name: str, rod: Rod, materials: Materials, planar: bool) -> dict[str, Any]:
    """Describe the sections of a rod to the engine.

    Parameters
    ----------
    name
        Its name.
    rod
        A rod whose section is made of fibres.
    materials
        The materials of the file.
    planar
        Whether the model is planar.
    """
    count = len(gauss_points(rod))
    if isinstance(rod.section, Stiffness):
        full = rod.section.full()
        described = {
            "fibres": [],
            "torsion": 0.0,
            "rigidity": [full[i][j] for i in range(6) for j in range(i, 6)],
            "mass": [float(rod.section.mass), 0.0, 0.0],
            "clearances": [],
        }
        return {"rod": name, "sections": [described], "of_gauss": [0] * count}
    built = geometries(rod, materials)
    radius, _ = surface(rod.radius, rod.sample_points)
    radii = radius[gauss_points(rod)]
    index = {material: i for i, material in enumerate(materials)}
    moduli = {key: material.material(key).shear_modulus for key, material in materials.items()}
    densities = {key: float(material.density) for key, material in materials.items()}
    rigidity = [0.0] * 21
    if isinstance(rod.section, Composite) and rod.section.torsion_stiffness is not None:
        rigidity[0] = float(rod.section.torsion_stiffness)
    lowered = [
        {
            "fibres": geometry.fibres(index, planar),
            "torsion": 0.0
            if geometry.torsion is None or "twist_x" not in rod.strain.modes
            else geometry.torsion(moduli, float(radii[place])),
            "rigidity": rigidity,
            "mass": geometry.mass(densities).tolist(),
            "clearances": [width.coefficients.tolist() for width, _ in geometry.clearances],
        }
        for place, geometry in enumerate(built)
    ]
    of_gauss = list(range(count)) if len(built) > 1 else [0] * count
    return {"rod": name, "sections": lowered, "of_gauss": of_gauss}
