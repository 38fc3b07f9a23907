"""Geometry of cross-sections: from shapes to the fibres and moments that the engine takes."""

from __future__ import annotations

from flexor.sections.across import points_across
from flexor.sections.geometry import Cavity, Geometry, Part
from flexor.sections.kinds import box, composite, half_round, solid, tube
from flexor.sections.linear import Linear
from flexor.sections.shapes import Rectangle, Sector
from flexor.sections.shear import shear_stiffness

__all__ = [
    "Cavity",
    "Geometry",
    "Linear",
    "Part",
    "Rectangle",
    "Sector",
    "box",
    "composite",
    "half_round",
    "points_across",
    "shear_stiffness",
    "solid",
    "tube",
]
