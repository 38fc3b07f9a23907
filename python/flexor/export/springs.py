"""Torsion springs with the stiffness of a joint."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

YOUNG_MODULUS = 206e9  # of spring steel wire, EN 10270-1 [Pa]
# Diameters of wire that are usual [m].
WIRES = tuple(1e-3 * d for d in (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.4, 1.6))
_FEWEST, _CLEARANCE = 2.0, 0.8e-3


@dataclass(frozen=True)
class Spring:
    """A torsion spring with legs at 180 degrees, on the pin of a hinge.

    Attributes
    ----------
    joint : str
        Name of the joint.
    stiffness : float
        [N m/rad]
    wire, diameter : float
        Of the wire, and in the middle of the coil [m].
    turns : float
        Number of active turns.
    moment, stress : float
        At the largest angle [N m] and [Pa].
    """

    joint: str
    stiffness: float
    wire: float
    diameter: float
    turns: float
    moment: float
    stress: float

    @property
    def body(self) -> float:
        """Length of the coil [m]."""
        return (self.turns + 1.0) * self.wire


def spring_for(
    joint: str, stiffness: float, angle: float, pin: float, room: tuple[float, float]
) -> Spring | None:
    """Choose the spring of a joint; None if none of usual wire fits.

    Bending of the wire gives the stiffness k = E d⁴/(64 D n), of n turns of the diameter D, and the
    stress 32 M/(π d³). Of the springs that fit, the one with the least stress is taken.

    Parameters
    ----------
    joint
        Its name.
    stiffness
        [N m/rad].
    angle
        Largest angle from rest [rad].
    pin
        Diameter of the pin on which it sits [m].
    room
        Diameter and width that are free for it [m].
    """
    found = []
    for wire in WIRES:
        diameter = pin + wire + _CLEARANCE
        if diameter + wire > room[0]:
            continue
        turns = YOUNG_MODULUS * wire**4 / (64.0 * diameter * stiffness)
        moment = stiffness * angle
        spring = Spring(
            joint, stiffness, wire, diameter, turns, moment, 32.0 * moment / (pi * wire**3)
        )
        if turns >= _FEWEST and spring.body <= room[1]:
            found.append(spring)
    return min(found, key=lambda each: each.stress, default=None)
