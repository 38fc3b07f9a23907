"""Hinges between printed links: a tongue in a fork, on a pin, with room for a torsion spring."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexor.arrays import Array
from flexor.export.solids import Solid, box, cone, extruded, united

_FAR = 1e3  # [mm]
LEG = 15.0  # length of a spring's leg [mm]


@dataclass(frozen=True)
class Hinge:
    """A hinge about the y axis through the origin; lengths in mm.

    Attributes
    ----------
    radius : float
        Of the sphere around its centre.
    lower, upper : float
        Angles at which it stops [rad].
    rest : float
        Angle at which its spring is relaxed [rad].
    pin : float
        Diameter of its pin.
    gap : float
        Between what moves.
    wire : float or None
        Diameter of its spring's wire; None without a spring.
    coil, length : float
        Diameter of the coil in its middle, and its length.
    """

    radius: float
    lower: float
    upper: float
    rest: float
    pin: float
    gap: float
    wire: float | None
    coil: float
    length: float

    @property
    def knuckle(self) -> float:
        """Radius of tongue and fork."""
        return 0.75 * self.radius

    @property
    def tongue(self) -> float:
        """Width of the tongue."""
        return 1.1 * self.radius

    @property
    def room(self) -> tuple[float, float]:
        """Diameter and width of the room for the spring."""
        return 1.1 * self.radius, 0.6 * self.radius

    def parent(self, solid: Solid) -> Solid:
        """Cut the fork into the end of a solid, which lies towards -x."""
        half = 0.5 * self.tongue + 0.5 * self.gap
        fork = self._cylinder(self.knuckle) - box(_all(), (-half, half), _all())
        beyond = box((-0.5 * self.gap, _FAR), _all(), _all()) - fork
        slot = self._cylinder(self.knuckle + self.gap) ^ box(_all(), (-half, half), _all())
        cut = [beyond, slot, self._wedges(1.0), self._hole(0.0)]
        return solid - united([*cut, *self._leg(-1.0)])

    def child(self, solid: Solid) -> Solid:
        """Cut the tongue into the base of a solid, which lies towards x."""
        half = 0.5 * self.tongue
        tongue = self._cylinder(self.knuckle) ^ box(_all(), (-half, half), _all())
        beyond = box((-_FAR, 0.5 * self.gap), _all(), _all()) - tongue
        room = self._cylinder(self.knuckle + self.gap) - box(_all(), (-half, half), _all())
        cut = [beyond, room, self._wedges(-1.0), self._hole(self.gap)]
        return solid - united([*cut, *self._leg(1.0), *self._coil()])

    def _cylinder(self, radius: float) -> Solid:
        return cone((0.0, -_FAR, 0.0), "y", 2.0 * _FAR, (radius, radius))

    def _hole(self, wider: float) -> Solid:
        return self._cylinder(0.5 * (self.pin + wider) + 0.05)

    def _coil(self) -> list[Solid]:
        """Return the room for the coil, open towards the parent, whose leg passes there."""
        if self.wire is None:
            return []
        y = (-0.5 * self.room[1], 0.5 * self.room[1])
        round_it = self._cylinder(0.5 * self.room[0]) ^ box(_all(), y, _all())
        return [round_it, box((-_FAR, 0.1), y, _all())]

    def _leg(self, side: float) -> list[Solid]:
        """Return the hole for a leg of the spring: along x above the pin, at rest."""
        if self.wire is None:
            return []
        radius = 0.5 * self.wire + 0.15
        offset = side * 0.5 * (self.length - self.wire)
        axis = "x" if side > 0.0 else "-x"
        hole = cone((0.0, offset, 0.5 * self.coil), axis, LEG, (radius, radius))
        # That of the parent is where the child's is when turned to the angle of rest.
        return [hole if side > 0.0 else hole.rotate((0.0, np.degrees(self.rest), 0.0))]

    def _wedges(self, side: float) -> Solid:
        """Return what either half leaves free outside the knuckle, so that it turns to its ends.

        Each half leaves half of the angle. `side` is 1 for the parent, -1 for the child.
        """
        pieces = []
        for angle, below in ((self.upper, True), (-self.lower, False)):
            half = 0.5 * max(angle, 0.0)
            down = -1.0 if below else 1.0
            edge = _FAR * np.array([-side * np.sin(half), down * np.cos(half)])
            pieces.append(_prism(np.array([[0.0, 0.0], [0.0, down * _FAR], edge])))
        return united(pieces) - self._cylinder(self.knuckle)


def _prism(corners: Array) -> Solid:
    """Return the prism along y of a triangle (3, 2) in x and z."""
    from flexor.export.outlines import area

    ordered = corners if area(corners) > 0.0 else corners[::-1]
    if abs(area(ordered)) < 1e-6:
        return box((0.0, 1e-3), (0.0, 1e-3), (0.0, 1e-3))
    return extruded(ordered, -_FAR, _FAR).rotate((0.0, 0.0, -90.0))


def _all() -> tuple[float, float]:
    return -_FAR, _FAR
