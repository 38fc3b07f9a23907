"""The kinds of sections as parts and cavities. S is half the height; z points up."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import pi, sin, sqrt
from typing import Literal

from flexor.sections.across import FEWEST
from flexor.sections.geometry import Cavity, Geometry, Part
from flexor.sections.linear import ZERO, Linear
from flexor.sections.shapes import Rectangle, Sector, Shape

THIN = 2  # points of the quadrature across a wall
# A wall that is wound outside thins towards the winding, and inner faces of a box have to become
# wider, which they do at its corners. This takes as much as each corner's area of fibres with ϱ = 2
# at the inner edge: at small strain, by the section's incompressible flow (docs/method.md); that it
# grows alike is what finite elements give.
CORNER_WINDING = Linear(sqrt(2.0))
Place = Literal["outside", "inside"]
Torsion = Callable[[Mapping[str, float], float], float]
SURFACE = Linear(0.0, 1.0)


def solid(kind: str, ratio: float, material: str) -> Geometry:
    """Return a disc, an ellipse or a rectangle of half-height S.

    Parameters
    ----------
    kind
        ``"circular"``, ``"elliptic"`` or ``"rectangular"``.
    ratio
        Half-width by S.
    material
        Name of its material.
    """
    if kind == "rectangular":
        shape: Shape = Rectangle(ZERO, ZERO, SURFACE * (2.0 * ratio), SURFACE * 2.0)
        inertia = 4.0 / 3.0 * ratio * (1.0 + ratio**2)
        factor = _rectangle_torsion(ratio) / inertia
    else:
        shape = Sector(ZERO, ZERO, ZERO, SURFACE, ratio=ratio)
        factor = 4.0 * ratio**2 / (1.0 + ratio**2) ** 2
    return Geometry((Part(shape, material),), torsion=lambda moduli, s: factor)


def tube(
    wall: Linear,
    material: str,
    stretch: float,
    winding: Place,
    wound: bool,
    strip: tuple[Linear, Linear, str, float] | None = None,
    across: int = FEWEST,
) -> Geometry:
    """Return a tube of outer radius S.

    Parameters
    ----------
    wall
        Thickness.
    material
        Name of its material.
    stretch
        In the reference state.
    winding
        Where a wound material has its winding.
    wound
        Whether the material is wound.
    strip
        Width, thickness, material and stretch of a layer along the underside, its middle in the
        surface.
    across
        Points of the quadrature across the wall; see `flexor.sections.across`.
    """
    bore = SURFACE - wall
    place = SURFACE if winding == "outside" else bore
    ring = Part(Sector(ZERO, ZERO, bore, SURFACE, across=across), material, stretch, place)
    inside: tuple[Shape, ...] = (Sector(ZERO, ZERO, ZERO, bore),)
    enclosed: tuple[Shape, ...] = (Sector(ZERO, ZERO, ZERO, place),) if wound else inside
    message = "wall leaves no bore: it must be less than the radius S"
    clearances = [(bore, message)]
    parts = [ring]
    if strip is not None:
        width, thickness, limiting, pretension = strip
        below = Rectangle(ZERO, _arc_height(width) * -1.0, width, thickness, (4, THIN))
        parts.append(Part(below, limiting, pretension, applied=True))
        clearances += [
            (SURFACE * 2.0 - width, "layer.width must be less than the diameter 2 S"),
            (wall - thickness, "layer.thickness must be less than the wall"),
        ]
    plain = Geometry((ring,))

    def torsion(moduli: Mapping[str, float], s: float) -> float:
        # A narrow strip on the surface twists with it, and hardly resists.
        return plain.polar(moduli, s) / geometry.polar(moduli, s)

    cavities = {"bore": Cavity(inside, enclosed)}
    geometry = Geometry(tuple(parts), cavities, tuple(clearances), torsion)
    return geometry


def _arc_height(width: Linear) -> Linear:
    """Return the mean height of an arc of this width on a circle of radius S.

    For a width that does not follow S, the height of its middle: for a third of the diameter, 2 %
    more.
    """
    if width.constant:
        return SURFACE
    half = 0.5 * width.multiple
    return SURFACE * (sin(half) / half)


def half_round(
    wall: Linear,
    floor: Linear,
    layer: tuple[Linear, str, float] | None,
    material: str,
    stretch: float,
    winding: Place,
    wound: bool,
    across: int = FEWEST,
) -> Geometry:
    """Return a half-tube on a floor; its height is 2 S.

    Parameters
    ----------
    wall, floor
        Thicknesses; that of the floor includes the layer.
    layer
        Thickness, material and stretch of the layer at the bottom of the floor.
    material, stretch, winding, wound, across
        As for `tube`. The winding outside encloses the floor as well.
    """
    base = floor - SURFACE
    outer = SURFACE * 2.0 - floor
    bore = outer - wall
    place = outer if winding == "outside" else bore
    ring = Sector(ZERO, base, bore, outer, half=True, across=across)
    arc = Part(ring, material, stretch, place)
    inside: tuple[Shape, ...] = (Sector(ZERO, base, ZERO, bore, half=True),)
    enclosed = inside
    if wound and winding == "outside":
        below = Rectangle(ZERO, floor * 0.5 - SURFACE, outer * 2.0, floor)
        enclosed = (Sector(ZERO, base, ZERO, outer, half=True), below)
    parts, clearances = _floor(outer * 2.0, floor, layer, material, stretch)
    message = "wall leaves no bore: with the floor it must be less than the height 2 S"

    def torsion(moduli: Mapping[str, float], s: float) -> float:
        t, b, r = wall.at(s), floor.at(s), outer.at(s) - 0.5 * wall.at(s)
        g = moduli[material]
        area = 0.5 * pi * r * r + r * b
        flow = (pi * r + b) / (g * t) + 2.0 * r / _floor_rigidity(floor, layer, material, moduli, s)
        return 4.0 * area * area / flow / geometry.polar(moduli, s)

    cavities = {"bore": Cavity(inside, enclosed)}
    geometry = Geometry((arc, *parts), cavities, ((bore, message), *clearances), torsion)
    return geometry


def box(
    width: Linear,
    wall: Linear,
    floor: Linear,
    layer: tuple[Linear, str, float] | None,
    material: str,
    stretch: float,
    winding: Place,
    wound: bool,
) -> Geometry:
    """Return a rectangular tube; its height is 2 S.

    Parameters
    ----------
    width
        Along y.
    wall
        Thickness of the sides and of the top.
    floor, layer, material, stretch, winding, wound
        As for `half_round`; flat walls are held flat, with hoop stretch 1 but at the corners.
    """
    height = SURFACE * 2.0 - wall - floor
    middle = (floor - wall) * 0.5
    inner = width - wall * 2.0
    side = (width - wall) * 0.5
    top = SURFACE - wall * 0.5
    walls = [Part(Rectangle(ZERO, top, inner, wall, (4, THIN)), material, stretch)]
    for y in (side, side * -1.0):
        walls.append(Part(Rectangle(y, middle, wall, height, (THIN, 4)), material, stretch))
        corner = Rectangle(y, top, wall, wall, (1, THIN))
        walls.append(Part(corner, material, stretch, ZERO if winding == "inside" else None))
        if wound and winding == "outside":
            for z, thickness in ((SURFACE - wall, wall), (floor - SURFACE, floor)):
                more = Rectangle(y, z, wall, thickness, (1, 1))
                walls.append(Part(more, material, stretch, CORNER_WINDING, stiffening=True))
    inside: tuple[Shape, ...] = (Rectangle(ZERO, middle, inner, height),)
    outline: tuple[Shape, ...] = (Rectangle(ZERO, ZERO, width, SURFACE * 2.0),)
    enclosed = outline if wound and winding == "outside" else inside
    parts, clearances = _floor(width, floor, layer, material, stretch)
    messages = (
        (height, "wall leaves no bore: with the floor it must be less than the height 2 S"),
        (inner, "wall leaves no bore: twice the wall must be less than the width"),
    )

    def torsion(moduli: Mapping[str, float], s: float) -> float:
        t, b = wall.at(s), floor.at(s)
        g = moduli[material]
        across, up = width.at(s) - t, 2.0 * s - 0.5 * (t + b)
        flow = (2.0 * up + across) / (g * t)
        flow += across / _floor_rigidity(floor, layer, material, moduli, s)
        return 4.0 * (across * up) ** 2 / flow / geometry.polar(moduli, s)

    cavities = {"bore": Cavity(inside, enclosed)}
    geometry = Geometry((*walls, *parts), cavities, (*messages, *clearances), torsion)
    return geometry


def composite(
    parts: list[Part], cavities: Mapping[str, Shape], torsion: Torsion | None
) -> Geometry:
    """Return a section of parts; pressure acts on the cavities themselves.

    Parameters
    ----------
    parts, cavities
        Its parts of material, and its cavities by name.
    torsion
        See `Geometry`.
    """
    hollow = {name: Cavity((shape,), (shape,)) for name, shape in cavities.items()}
    return Geometry(tuple(parts), hollow, torsion=torsion)


def _floor(
    width: Linear,
    floor: Linear,
    layer: tuple[Linear, str, float] | None,
    material: str,
    stretch: float,
) -> tuple[list[Part], tuple[tuple[Linear, str], ...]]:
    """Return the parts of a floor, and what must be positive."""
    if layer is None:
        whole = Rectangle(ZERO, floor * 0.5 - SURFACE, width, floor, (4, THIN))
        return [Part(whole, material, stretch)], ()
    thickness, limiting, pretension = layer
    above = floor - thickness
    low = Rectangle(ZERO, thickness * 0.5 - SURFACE, width, thickness, (4, THIN))
    high = Rectangle(ZERO, thickness + above * 0.5 - SURFACE, width, above, (4, THIN))
    parts = [Part(low, limiting, pretension), Part(high, material, stretch)]
    return parts, ((above, "layer.thickness must be less than the floor"),)


def _floor_rigidity(
    floor: Linear,
    layer: tuple[Linear, str, float] | None,
    material: str,
    moduli: Mapping[str, float],
    s: float,
) -> float:
    """Return Σ G t across a floor [N/m]."""
    t, g = floor.at(s), moduli[material]
    if layer is None:
        return g * t
    thin = layer[0].at(s)
    return g * (t - thin) + moduli[layer[1]] * thin


def _rectangle_torsion(ratio: float) -> float:
    """Saint-Venant torsion constant of a rectangle with half-sides 1 and `ratio`, by its series."""
    from math import tanh

    long, short = 2.0 * max(ratio, 1.0), 2.0 * min(ratio, 1.0)
    odd = range(1, 400, 2)
    series = sum(tanh(m * pi * long / (2.0 * short)) / m**5 for m in odd)
    return long * short**3 / 3.0 * (1.0 - 192.0 * short / (pi**5 * long) * series)
