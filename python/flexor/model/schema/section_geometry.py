"""Sections along a rod: from the tables to shapes, and to the engine's description."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor import sections
from flexor.arrays import Array
from flexor.errors import InputError, unknown_name
from flexor.materials import library
from flexor.model.schema.body import Rod
from flexor.model.schema.material import Material
from flexor.model.schema.profile import Spline, interpolated, surface
from flexor.model.schema.section import (
    Box,
    Composite,
    Floored,
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
from flexor.model.schema.table import Table
from flexor.model.validation import field_error
from flexor.sections import Geometry, Linear
from flexor.sections.across import FEWEST

Materials = Mapping[str, Material]
# What may be given at several places along a rod.
_SIZES = ("wall", "floor", "width", "height", "radius", "thickness")


def is_made_of_fibres(rod: Rod) -> bool:
    """Whether the engine needs the fibres of a rod's section."""
    return rod.material is not None or not isinstance(rod.section, Solid)


def gauss_points(rod: Rod) -> NDArray[np.intp]:
    """Return which sample points of a rod are Gauss points."""
    return rod.gauss_rule[0]


def check_section(rod: Rod, path: str, materials: Materials, planar: bool) -> None:
    """Check that a rod's section can be made of the materials there are.

    Parameters
    ----------
    rod
        The rod.
    path
        Dotted path of its table, for messages.
    materials
        The materials of the file.
    planar
        Whether the model is planar.

    Raises
    ------
    PydanticCustomError
        Naming the field that is wrong.
    """
    if rod.material is not None and rod.material not in materials:
        raise field_error(_unknown(rod.material, materials), f"{path}.material")
    if not is_made_of_fibres(rod):
        return
    names = [f"{path}.section"]
    if isinstance(rod.section, tuple):
        names = [f"{path}.section[{index}]" for index in range(len(rod.pieces))]
    for place, section in zip(names, rod.pieces, strict=True):
        for key, name in materials_of(section):
            if name is None and rod.material is None:
                tail = "is missing: name one of [materials], here or as the rod's material"
                raise field_error(tail, f"{place}.{key}")
            if name is not None and name not in materials:
                raise field_error(_unknown(name, materials), f"{place}.{key}")
    radius = rod.surface.radius
    rod.fix_points_across(points_across(rod, materials))
    built, _ = geometries(rod, materials)
    pieces = rod.pieces_at(rod.sample_points)
    _check_clearances(rod, materials, names)
    for piece, geometry in built:
        if geometry is None:
            continue
        section = rod.pieces[piece]
        try:
            if isinstance(section, Composite):
                for s in (radius[pieces == piece].max(), radius[pieces == piece].min()):
                    geometry.check_parts(float(s), _part_names(section))
        except InputError as error:
            raise field_error(f"cannot be made: {error}", names[piece]) from None
        if planar and not geometry.is_symmetric(float(radius.mean())):
            tail = "is not symmetric in y, as a section of a planar model has to be"
            raise field_error(tail, names[piece])


def _check_clearances(rod: Rod, materials: Materials, names: list[str]) -> None:
    """Check that walls leave room at every sample point, both ends of each section among them."""
    points = rod.sample_points
    places = rod.pieces_at(points)
    for place in range(len(rod.pieces)):
        here = places == place
        # The place where a section begins belongs to the one before.
        here[max(int(np.flatnonzero(here)[0]) - 1, 0)] = True
        at = np.flatnonzero(here)
        for rows, geometry in along(rod, materials, place, points[at]):
            for row in at[rows] if geometry is not None else ():
                try:
                    geometry.check(float(rod.surface.radius[row]))  # type: ignore[union-attr]
                except InputError as error:
                    tail = f"cannot be made: {error} at X = {points[row]:.3g}"
                    raise field_error(tail, names[place]) from None


def _unknown(name: str, materials: Materials) -> str:
    return f"refers to the {unknown_name('material', name, {**library(), **materials})}"


def _part_names(section: Composite) -> dict[int, str]:
    order = [i for i, part in enumerate(section.parts) if part.cavity is None]
    order += [i for i, part in enumerate(section.parts) if part.cavity is not None]
    return {place: f"parts[{i}]" for place, i in enumerate(order)}


Built = tuple[int, Geometry | None]


def geometries(rod: Rod, materials: Materials) -> tuple[list[Built], list[int]]:
    """Return the sections that a rod has, and which of these each Gauss point has.

    Each with its place among the pieces of the rod; without geometry if its stiffness is given.
    """
    built: list[Built] = []
    index: dict[tuple[int, float], int] = {}
    of_gauss = []
    vary = [varies(piece) for piece in rod.pieces]
    points = rod.sample_points[gauss_points(rod)]
    for place, x in zip(rod.pieces_at(points).tolist(), points.tolist(), strict=True):
        key = (place, x if vary[place] else 0.0)
        if key not in index:
            index[key] = len(built)
            built.append((place, section_at(rod, materials, place, x)))
        of_gauss.append(index[key])
    return built, of_gauss


def points_across(rod: Rod, materials: Materials) -> tuple[int, ...]:
    """Return the points of the quadrature across the wall of each section, where it is thickest.

    Those of the file that a rod is a design of, if there is one.
    """
    if rod.points_across is not None:
        return rod.points_across
    at_gauss = gauss_points(rod)
    points, radius = rod.sample_points[at_gauss], rod.surface.radius[at_gauss]
    places = rod.pieces_at(points)
    found = []
    for place, section in enumerate(rod.pieces):
        thickest, outside = 0.0, False
        if isinstance(section, (Tube, HalfRound)) and _is_wound(section, rod, materials):
            outside = section.winding == "outside"
            for x, s in zip(points[places == place], radius[places == place], strict=True):
                floor = _linear(section.floor, x).at(s) if isinstance(section, HalfRound) else s
                thickest = max(thickest, _linear(section.wall, x).at(s) / (2.0 * s - floor))
        # A wall that leaves no bore is refused elsewhere.
        possible = 0.0 < thickest < 1.0
        found.append(sections.points_across(thickest, outside) if possible else FEWEST)
    return tuple(found)


def _is_wound(section: Hollow, rod: Rod, materials: Materials) -> bool:
    material = section.material or rod.material
    return material is not None and materials[material].winding == "hoop"


def section_at(rod: Rod, materials: Materials, piece: int, x: float) -> Geometry | None:
    """Return one of a rod's sections as it is at X; None if only its stiffness is given.

    Parameters
    ----------
    rod
        The rod.
    materials
        The materials of the file.
    piece
        Which of its sections.
    x
        X in [0, 1].
    """
    section = rod.pieces[piece]
    given = isinstance(section, Stiffness)
    if given:
        return None
    across = points_across(rod, materials)[piece]
    return _geometry(section, rod.material or "", materials, x, across)


def varies(section: Section) -> bool:
    """Whether a section has sizes that are given at several places along the rod."""
    tables: list[Table] = [section]
    if isinstance(section, Composite):
        tables += section.parts
    elif isinstance(section, (Floored, Tube)) and section.layer is not None:
        tables.append(section.layer)
    return any(name in _SIZES and _is_several(size) for t in tables for name, size in t)


def _is_several(size: object) -> bool:
    return isinstance(size, tuple) or (isinstance(size, Spline) and len(size.spline) > 1)


def _linear(size: Any, x: float) -> Linear:
    if isinstance(size, (tuple, Spline)):
        return Linear(float(interpolated(size, np.array([x]))[0][0]))
    return Linear(float(size)) if hasattr(size, "text") else Linear(0.0, float(size))


def _layer(layer: Layer | None, x: float) -> tuple[Linear, str, float] | None:
    return None if layer is None else (_linear(layer.thickness, x), layer.material, layer.stretch)


def _geometry(
    section: Section, own: str | None, materials: Materials, x: float, across: int
) -> Geometry:
    if isinstance(section, Solid):
        assert own is not None
        return sections.solid(section.kind, section.ratio or 1.0, own)
    if isinstance(section, Composite):
        return _composite(section, own, x)
    assert isinstance(section, Hollow)
    material = section.material or own
    assert material is not None
    wall = _linear(section.wall, x)
    wound = materials[material].winding == "hoop"
    rest = (material, section.stretch, section.winding, wound)
    if isinstance(section, Tube):
        width = None if section.layer is None else _linear(section.layer.width, x)
        strip = _layer(section.layer, x)
        return sections.tube(
            wall, *rest, None if strip is None or width is None else (width, *strip), across
        )
    if isinstance(section, HalfRound):
        floor = _linear(section.floor, x)
        return sections.half_round(wall, floor, _layer(section.layer, x), *rest, across)
    assert isinstance(section, Box)
    floor = wall if section.floor is None else _linear(section.floor, x)
    width = _linear(section.width, x)
    return sections.box(width, wall, floor, _layer(section.layer, x), *rest)


def _composite(section: Composite, own: str | None, x: float) -> Geometry:
    parts, cavities = [], {}
    for part in section.parts:
        shape = _shape(part, x)
        if part.cavity is not None:
            cavities[part.cavity] = shape
        else:
            material = part.material or own
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


def half_width(rod: Rod, materials: Materials, radius: Array, points: Array) -> Array:
    """Return half of the width of a rod, along y.

    Parameters
    ----------
    rod
        The rod.
    materials
        The materials of the file.
    radius : (n,) array
        S at points along it [m].
    points : (n,) array
        Where they are, X in [0, 1].
    """
    if not is_made_of_fibres(rod):
        assert isinstance(rod.section, Solid)
        return (rod.section.ratio or 1.0) * radius
    found = radius.copy()
    places = rod.pieces_at(points)
    for place in range(len(rod.pieces)):
        of_piece = np.flatnonzero(places == place)
        for rows, geometry in along(rod, materials, place, points[of_piece]):
            if geometry is not None:
                here = of_piece[rows]
                shapes = [part.shape for part in geometry.parts]
                each = [np.broadcast_to(a.extent(radius[here])[1], here.shape) for a in shapes]
                found[here] = np.max(each, axis=0)
    return found


def along(
    rod: Rod, materials: Materials, place: int, points: Array
) -> Iterator[tuple[NDArray[np.intp], Geometry | None]]:
    """Return one of a rod's sections at points along it.

    Parameters
    ----------
    rod
        The rod.
    materials
        The materials of the file.
    place
        Which of its sections.
    points : (n,) array
        X in [0, 1].

    Yields
    ------
    rows, geometry : (k,) array and Geometry
        Points with the same sizes, and the section there; None if it is given by its stiffness.
    """
    piece, rows = rod.pieces[place], np.arange(len(points))
    for group in rows[:, None] if varies(piece) else [rows] if len(rows) else []:
        yield group, section_at(rod, materials, place, float(points[group[0]]))


def roundness(rod: Rod, materials: Materials) -> float:
    """Return S times the curvature of a rod's underside across in its middle; 0 where flat.

    Parameters
    ----------
    rod
        The rod.
    materials
        The materials of the file.
    """
    (place,) = rod.pieces_at(np.array([0.5])).tolist()
    piece = rod.pieces[place]
    if isinstance(piece, Solid) and not is_made_of_fibres(rod):
        return 0.0 if piece.kind == "rectangular" else 1.0 / (piece.ratio or 1.0) ** 2
    if isinstance(piece, (Stiffness, Tube)):
        return 1.0
    s = float(surface(rod.radius, np.array([0.5]))[0][0])
    geometry = section_at(rod, materials, place, 0.5)
    assert geometry is not None
    parts = geometry.parts
    lowest = min((part.shape for part in parts), key=lambda shape: shape.extent(s)[2])
    if isinstance(lowest, sections.Rectangle) or lowest.half:
        return 0.0
    # Of a part that follows S this is the same for all designs, but for rounding.
    return float(round(s / lowest.outer.at(s), 12))


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
    built, of_gauss = geometries(rod, materials)
    radii = rod.surface.radius[gauss_points(rod)]
    index = {material: i for i, material in enumerate(materials)}
    moduli = {key: material.material(key).shear_modulus for key, material in materials.items()}
    axial = {key: float(m.material(key).energy(1.0).second) for key, m in materials.items()}
    densities = {key: float(material.density) for key, material in materials.items()}
    lowered = []
    for number, (piece, geometry) in enumerate(built):
        section = rod.pieces[piece]
        described: dict[str, Any] = {
            "fibres": [],
            "torsion": 0.0,
            "shear": [1.0, 1.0],
            "rigidity": [0.0] * 21,
        }
        if isinstance(section, Stiffness):
            full = section.full()
            described["rigidity"] = [full[i][j] for i in range(6) for j in range(i, 6)]
            described["mass"] = [float(section.mass)] + [0.0] * 10
            described["clearances"] = []
        else:
            assert geometry is not None
            described["fibres"] = geometry.fibres(index, planar)
            s = float(radii[of_gauss.index(number)])
            if geometry.torsion is not None and "twist_x" in rod.strain.modes:
                described["torsion"] = geometry.torsion(moduli, s)
            if not isinstance(section, Solid) and {"shear_y", "shear_z"} & set(rod.strain.modes):
                whole = geometry.shear_in_series(moduli, s)
                found = sections.shear_stiffness(geometry.parts, axial, moduli, s)
                described["shear"] = [each / whole for each in found]
            if isinstance(section, Composite) and section.torsion_stiffness is not None:
                described["rigidity"][0] = float(section.torsion_stiffness)
            described["mass"] = geometry.mass(densities).tolist()
            described["clearances"] = [w.coefficients.tolist() for w, _ in geometry.clearances]
        lowered.append(described)
    return {"rod": name, "sections": lowered, "of_gauss": of_gauss}
