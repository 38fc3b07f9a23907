"""Vectors as tables of components, which default to zero."""

from __future__ import annotations

from flexor.model import units
from flexor.model.schema.table import Table
from flexor.model.units import Acceleration, Angle, Force, Length, Moment

Triple = tuple[float, float, float]


class Vector(Table):
    """Components along the axes of a frame."""

    x: float
    y: float
    z: float

    @property
    def components(self) -> Triple:
        """The three components, in SI units."""
        return (float(self.x), float(self.y), float(self.z))


class Offset(Vector):
    """A point or an offset, such as ``{ z = "2 cm" }``."""

    x: Length = units.LENGTH.si(0.0)
    y: Length = units.LENGTH.si(0.0)
    z: Length = units.LENGTH.si(0.0)


class Rotation(Vector):
    """A rotation vector (axis times angle), such as ``{ y = "30 deg" }``."""

    x: Angle = units.ANGLE.si(0.0)
    y: Angle = units.ANGLE.si(0.0)
    z: Angle = units.ANGLE.si(0.0)


class ForceVector(Vector):
    """A force, such as ``{ z = "-1 N" }``."""

    x: Force = units.FORCE.si(0.0)
    y: Force = units.FORCE.si(0.0)
    z: Force = units.FORCE.si(0.0)


class MomentVector(Vector):
    """A moment, such as ``{ y = "0.1 N*m" }``."""

    x: Moment = units.MOMENT.si(0.0)
    y: Moment = units.MOMENT.si(0.0)
    z: Moment = units.MOMENT.si(0.0)


class Gravity(Vector):
    """The acceleration of gravity, such as ``{ z = "-9.81 m/s^2" }``."""

    x: Acceleration = units.ACCELERATION.si(0.0)
    y: Acceleration = units.ACCELERATION.si(0.0)
    z: Acceleration = units.ACCELERATION.si(0.0)
