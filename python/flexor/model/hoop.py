"""Hoop strain of cavities without a winding under pressure."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema.pressure import Pressure
from flexor.model.schema.profile import Spline, interpolated
from flexor.model.schema.section import (
    Box,
    Composite,
    HalfRound,
    Hollow,
    Tube,
    cavities_of,
    materials_of,
)

if TYPE_CHECKING:
    from flexor.model.path_quantities import PathQuantities

# The unwound half-round bends backwards in finite elements (docs/finite-elements.md) from its first
# pressure on, 0.5 kPa, where this is its strain; one that is wound has none.
LIMIT = 0.002


def hoop_strains(path: PathQuantities) -> Iterator[tuple[str, str, Array]]:
    """Estimate the hoop strain per pressure at the bore of each cavity without winding.

    Parameters
    ----------
    path
        Equilibria of one design.

    Yields
    ------
    pressure, rod, strain : str, str and (P,) array
        Name of the pressure, its rod, and the strain along it by its pressure [1/Pa].

    Notes
    -----
    Lamé's thick-walled tube of an incompressible material in plane strain, for bore radius a and
    outer radius b: 3 p b² / (2 E (b² - a²)); of a box with a half of its bore's width. Flat walls
    that are not held bulge more.
    """
    file = path.model.file
    for name, pressure in file.actuators.items():
        if not isinstance(pressure, Pressure):
            continue
        rod = file.rod(pressure.rod)
        s, x = path.model.slot(f"{pressure.rod}.radius", path.parameters), rod.sample_points
        places = rod.pieces_at(x)
        for place, section in enumerate(rod.pieces):
            if not isinstance(section, Hollow):
                continue
            material = section.material or rod.material
            if material is None or file.materials[material].winding == "hoop":
                continue
            young = file.materials[material].material(material).young_modulus
            outer, wall = _outer(section, s, x), _size(section.wall, s, x)
            strain = 1.5 * outer**2 / (young * (outer**2 - (outer - wall) ** 2))
            yield name, pressure.rod, np.where(places == place, strain, 0.0)


def pressed_composites(path: PathQuantities) -> Iterator[tuple[str, bool]]:
    """Yield the pressures on cavities of composites, and whether some material of these is wound.

    How an unwound one widens depends on shapes that may be any, and so does how a wound one thins.
    """
    file = path.model.file
    for name, pressure in file.actuators.items():
        if not isinstance(pressure, Pressure):
            continue
        rod = file.rod(pressure.rod)
        for section in rod.pieces:
            if not isinstance(section, Composite) or not cavities_of(section):
                continue
            if pressure.cavity is not None and pressure.cavity not in cavities_of(section):
                continue
            made_of = {material or rod.material or "" for _, material in materials_of(section)}
            yield name, any(file.materials[material].winding == "hoop" for material in made_of)
            break


def _outer(section: Hollow, s: Array, x: Array) -> Array:
    if isinstance(section, Tube):
        return s
    if isinstance(section, HalfRound):
        return 2.0 * s - _size(section.floor, s, x)
    assert isinstance(section, Box)
    return 0.5 * _size(section.width, s, x)


def _size(size: object, s: Array, x: Array) -> Array:
    if isinstance(size, (tuple, Spline)):
        return interpolated(size, x)[0]
    return np.full_like(s, float(size)) if hasattr(size, "text") else float(size) * s  # type: ignore[arg-type]
