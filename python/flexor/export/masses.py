"""Volumes and masses of what is cast, and of what is printed."""

from __future__ import annotations

from dataclasses import dataclass

from flexor.export.body import Body, drills
from flexor.export.outlines import area
from flexor.export.sheets import Sheet, cast_material, sheets
from flexor.export.solids import united


@dataclass(frozen=True)
class Portion:
    """What is poured or cut.

    Attributes
    ----------
    name : str
        Such as ``"body"`` or ``"cap at the base"``.
    material : str
        Name of its material in the model; empty for the rod's own.
    volume : float
        [m³].
    mass : float
        [kg]; 0 where the density is not known.
    """

    name: str
    material: str
    volume: float
    mass: float


def portions(body: Body) -> list[Portion]:
    """Return what is cast: the body without its layers, and its caps without their inlets."""
    material = cast_material(body)
    density = body.device.density(material)
    inside = [s for s in sheets(body) if s.name.startswith("layer") and not s.applied]
    layers = sum(_volume(each) for each in inside)
    cast = {"body": float(body.cast.volume()) - layers}
    for end, solid in body.caps.items():
        holes = drills(body, end)
        left = solid - united(holes) if holes else solid
        cast[f"cap at the {end}"] = float(left.volume())
    return [
        Portion(name, material, 1e-9 * volume, 1e-9 * volume * density)
        for name, volume in cast.items()
    ]


def _volume(sheet: Sheet) -> float:
    """Volume of a sheet [mm³]; slots are cut out."""
    return sum(area(contour) for contour in sheet.contours) * sheet.thickness
