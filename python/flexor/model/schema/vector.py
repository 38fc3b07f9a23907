"""Directions, and vectors as tables of components, which default to zero."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import BeforeValidator

from flexor.model import units
from flexor.model.schema.table import Number, Table
from flexor.model.units import Acceleration, Angle, Force, Length, Moment
from flexor.model.validation import describe, field_error

Triple = tuple[float, float, float]
_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def _axis(value: object) -> object:
    if isinstance(value, str):
        if value not in _AXES:
            raise field_error(
                f'is {describe(value)}: expected "x", "y", "z" or a list of three numbers'
            )
        return _AXES[value]
    return value


Axis = Annotated[tuple[Number, Number, Number], BeforeValidator(_axis)]


def direction(axis: Triple) -> list[float]:
    """Return the unit vector along an axis."""
    scaled = np.array(axis) / np.max(np.abs(axis))  # or the norm of a huge axis would overflow
    unit: list[float] = (scaled / np.linalg.norm(scaled)).tolist()
    return unit


def shown(axis: Triple) -> str:
    """Return the axis as a file may have it: a name in quotes, or three numbers."""
    names = [name for name, unit in _AXES.items() if unit == axis]
    return f'"{names[0]}"' if names else str(list(axis))


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
