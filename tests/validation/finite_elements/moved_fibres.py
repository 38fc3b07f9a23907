"""A half-round section in pure bending, with fibres that stay or that move as its wall thins.

In the section that a winding keeps, the incompressible wall of a stretched fibre thins towards the
winding, so that the fibre moves outwards, further from the floor, and is stretched more. Both are
integrated here, independently of the rod, for an inextensible layer at the underside.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from .actuators import SHEAR, Actuator
from .sections import Array

POINTS = 8
MOVES = 16  # the hoop stretch converges by about a digit for each


def angle(actuator: Actuator, pressure: float, moved: bool) -> float:
    """Return the bending angle [degrees] of a half-round chamber at a pressure [kPa]."""
    bore, wall, floor = actuator.sizes
    outer = bore + wall
    # First moment of what the winding encloses, about the underside [mm^3].
    arm = np.pi * outer**2 / 2.0 * (floor + 4.0 * outer / (3.0 * np.pi)) + outer * floor**2

    def moment(curvature: float) -> float:
        step = 1e-6
        ahead, behind = (energy(actuator, curvature + sign * step, moved) for sign in (1.0, -1.0))
        return (ahead - behind) / (2.0 * step)

    found = brentq(lambda k: moment(k) - 1e-3 * pressure * arm, 1e-5, 0.06)
    return float(np.degrees(found * actuator.length))


def energy(actuator: Actuator, curvature: float, moved: bool) -> float:
    """Return the energy of the section per length [mJ/mm]; the curvature is in 1/mm."""
    bore, wall, floor = actuator.sizes
    outer = bore + wall
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    radius = (bore + 0.5 * wall * (nodes + 1.0))[:, None]
    around = 0.25 * np.pi * (nodes + 1.0)
    # Both halves of the arc.
    area = 2.0 * np.outer(0.5 * wall * weights, 0.25 * np.pi * weights) * radius
    up = np.sin(around)
    stretch = 1.0 + curvature * (floor + radius * up)
    hoop = hoop_stretch(stretch, radius, outer)
    if moved:
        for _ in range(MOVES):
            # Mean stretch, by area, of the wall between the fibre and the winding.
            place = radius * hoop
            middle = (outer**2 + outer * place + place**2) * 2.0 / (3.0 * (outer + place))
            hoop = hoop_stretch(1.0 + curvature * (floor + middle * up), radius, outer)
        stretch = 1.0 + curvature * (floor + radius * hoop * up)
    total = (area * density(stretch, hoop)).sum()
    height = 0.5 * floor * (nodes + 1.0)
    flat = density(1.0 + curvature * height, np.ones(POINTS))
    return float(total + (outer * floor * weights * flat).sum())


def hoop_stretch(stretch: Array, radius: Array, outer: float) -> Array:
    """Return the hoop stretch at a radius of a wall that is stretched alike up to its winding."""
    return np.sqrt(outer**2 - (outer**2 - radius**2) / stretch) / radius


def density(stretch: Array, hoop: Array) -> Array:
    """Return the energy of neo-Hookean silicone per volume [MPa]."""
    invariant = stretch**2 + hoop**2 + 1.0 / (stretch * hoop) ** 2
    return SHEAR / 2.0 * (invariant - 3.0)
