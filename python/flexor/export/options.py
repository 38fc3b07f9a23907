"""Choices of the maker: what the mechanics leaves open."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class BodyOptions:
    """Dimensions of the body that are not in the model [m].

    Attributes
    ----------
    cap : float
        Thickness of the wall that closes a chamber at its ends.
    inlet : float
        Diameter of the hole for the tube.
    strap : float
        Width of straps that have none in the model.
    strap_thickness : float
        Thickness of the webbing.
    ear : float
        Thickness of the ears beside the body through which straps are threaded.
    margin : float
        Material around the slots of the ears.
    fold : float
        Length of a strap's end that is folded back and fastened.
    """

    cap: float = 5e-3
    inlet: float = 3e-3
    strap: float = 15e-3
    strap_thickness: float = 1.5e-3
    ear: float = 2.5e-3
    margin: float = 3e-3
    fold: float = 30e-3


@dataclass(frozen=True)
class MouldOptions:
    """Dimensions of the mould [m, rad].

    Attributes
    ----------
    wall : float
        Thickness of its walls.
    pour, vent : float
        Diameters of the holes for silicone and for air.
    draft : float
        Angle by which the cavity widens towards the parting surface.
    shrinkage : float
        Share of its length by which the silicone shrinks.
    clearance : float
        Gap between parts that are put together.
    least_wall : float
        Thinnest wall that the printer and the silicone allow.
    stretch : float
        By how much silicone may be stretched, along its circumference, when a core is pulled.
    grip : float
        Depth to which a lid holds the body.
    """

    wall: float = 6e-3
    pour: float = 5e-3
    vent: float = 2e-3
    draft: float = 0.0
    shrinkage: float = 0.0
    clearance: float = 0.15e-3
    least_wall: float = 1e-3
    stretch: float = 0.5
    grip: float = 6e-3
