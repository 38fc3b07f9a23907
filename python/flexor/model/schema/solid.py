"""Solid obstacles and sleeves: spheres, capsules, cylinders and boxes."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from flexor.arrays import Array
from flexor.model import units
from flexor.model.schema.body import Rod
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.obstacle import HalfSpace, Obstacle
from flexor.model.schema.planar import about_y
from flexor.model.schema.table import Switch, Table, one_of
from flexor.model.schema.vector import Axis, Rotation, Triple, direction, shown
from flexor.model.units import NonNegativeLength, PositiveLength
from flexor.model.validation import field_error


class Solid(Obstacle):
    """An obstacle around its origin or, with ``inside``, what surrounds that: a sleeve.

    It consists of all points within a radius of a box, of which a point, a segment and a line are
    limits.
    """

    inside: Switch = False

    def excludes(self, rod: Rod, touching: bool) -> bool:
        """Whether it is a solid, which nothing can be in, or a sleeve that the rod touches."""
        return touching or not self.inside

    @property
    @abstractmethod
    def half(self) -> Triple:
        """Half of the box's size along the obstacle's axes [m]; infinite where it is endless."""

    @property
    @abstractmethod
    def rounded_by(self) -> float:
        """The radius around the box [m]."""

    @property
    def half_width(self) -> float:
        """Half of its smallest extent [m]; infinite where it has no other side."""
        return math.inf if self.inside else min(self.half) + self.rounded_by

    def distance(self, place: Array) -> Array:
        """Return how far places are from the surface [m]."""
        beyond = np.abs(place) - np.array(self.half)
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
        found = np.where(outside > 0.0, outside, beyond.max(axis=-1)) - self.rounded_by
        return np.asarray(-found if self.inside else found)

    def surfaces(self, planar: bool) -> list[dict[str, Any]]:
        """Describe the surface to the engine."""
        half = [size if np.isfinite(size) else None for size in self.half]
        return [{"rounded": {"half": half, "radius": self.rounded_by, "inside": self.inside}}]


class Ball(Solid):
    """A sphere, ``kind = "sphere"``, around ``point``."""

    kind: Literal["sphere"]
    radius: PositiveLength

    @property
    def is_curved(self) -> bool:
        """Whether it is round."""
        return True

    @property
    def half(self) -> Triple:
        """A point."""
        return (0.0, 0.0, 0.0)

    @property
    def rounded_by(self) -> float:
        """Its radius [m]."""
        return float(self.radius)


class _Round(Solid):
    """A solid of revolution about an axis through ``point``."""

    axis: Axis
    radius: PositiveLength

    @property
    def is_curved(self) -> bool:
        """Whether it is round."""
        return True

    @property
    def line(self) -> Triple:
        """Unit vector along it."""
        x, y, z = direction(self.axis)
        return (x, y, z)

    @model_validator(mode="after")
    def _check(self) -> _Round:
        if not any(self.axis):
            raise field_error("has no direction: it must not be zero", path="axis")
        return self

    def check_planar(self, path: str) -> None:
        """Reject an axis that is neither in the plane nor normal to it."""
        super().check_planar(path)
        x, y, z = self.axis
        if y != 0.0 and (x != 0.0 or z != 0.0):
            tail = "in a planar model it must be y or lie in the x-z plane"
            raise field_error(f"is {shown(self.axis)}: {tail}", f"{path}.axis")

    @property
    def rounded_by(self) -> float:
        """Its radius [m]."""
        return float(self.radius)

    @property
    def _nearest(self) -> int:
        """The coordinate axis that is nearest to its axis."""
        return int(np.argmax(np.abs(self.axis)))

    @property
    def turn(self) -> Triple:
        """The least rotation that takes the nearest coordinate axis to its axis [rad]."""
        target = np.array(direction(self.axis))
        start = np.zeros(3)
        start[self._nearest] = np.copysign(1.0, target[self._nearest])
        about = np.cross(start, target)
        sine = float(np.linalg.norm(about))
        if sine == 0.0:
            return (0.0, 0.0, 0.0)
        x, y, z = (about / sine * np.arctan2(sine, float(start @ target))).tolist()
        return (x, y, z)

    def _along(self, size: float) -> Triple:
        half = [0.0, 0.0, 0.0]
        half[self._nearest] = size
        return (half[0], half[1], half[2])


class Capsule(_Round):
    """A cylinder with half-spheres as ends, ``kind = "capsule"``; ``length`` is without them."""

    kind: Literal["capsule"]
    length: PositiveLength

    @property
    def half(self) -> Triple:
        """A segment."""
        return self._along(0.5 * float(self.length))


class Cylinder(_Round):
    """An endless cylinder, ``kind = "cylinder"``."""

    kind: Literal["cylinder"]

    @property
    def half(self) -> Triple:
        """A line."""
        return self._along(np.inf)


class Size(Table):
    """The size of a box along its axes; in a planar model that along y does not count."""

    x: PositiveLength
    y: PositiveLength | None = None
    z: PositiveLength


class Box(Solid):
    """A box, ``kind = "box"``, with ``point`` in its middle.

    ``rounding`` is the radius of its edges; the walls of a box that is open inside meet in sharp
    edges, and each of them acts by itself.
    """

    kind: Literal["box"]
    size: Size
    rotation: Rotation = Rotation()
    rounding: NonNegativeLength = units.LENGTH.si(0.0)

    @model_validator(mode="after")
    def _check(self) -> Box:
        sizes = [self.size.x, self.size.z, *([] if self.size.y is None else [self.size.y])]
        if self.inside and self.rounding > 0.0:
            tail = f"is {_text(self.rounding)}: the walls of a box that is open inside have none"
            raise field_error(tail, path="rounding")
        if self.rounding > 0.5 * min(sizes):
            tail = f"is {_text(self.rounding)}: it must be at most half of the smallest size"
            raise field_error(f"{tail}, {_text(min(sizes))}", path="rounding")
        return self

    def check(self, path: str, system: BodySystem) -> None:
        """Check that its size along y is given in space, besides what all obstacles are."""
        if self.size.y is None and not system.planar:
            raise field_error('is missing: a length, such as "10 cm"', f"{path}.size.y")
        super().check(path, system)

    def check_planar(self, path: str) -> None:
        """Reject a rotation that is not about y."""
        super().check_planar(path)
        about_y(self.rotation, f"{path}.rotation")

    @property
    def turn(self) -> Triple:
        """Its rotation vector [rad]."""
        return self.rotation.components

    @property
    def half(self) -> Triple:
        """What the edges are rounded around; endless along y if its size is not given."""
        x, y, z = (
            np.inf if size is None else 0.5 * float(size) - self.rounded_by
            for size in (self.size.x, self.size.y, self.size.z)
        )
        return (x, y, z)

    @property
    def rounded_by(self) -> float:
        """Radius of its edges [m]."""
        return float(self.rounding)

    def surfaces(self, planar: bool) -> list[dict[str, Any]]:
        """Describe the surface to the engine: inside, one plane for each wall."""
        if not self.inside:
            return super().surfaces(planar)
        walls = []
        for axis in (0, 2) if planar else (0, 1, 2):
            for sign in (1.0, -1.0):
                normal = [0.0, 0.0, 0.0]
                normal[axis] = sign
                walls.append({"plane": {"normal": normal, "distance": -self.half[axis]}})
        return walls


def _text(length: float) -> str:
    return f'"{getattr(length, "text", None) or f"{length:g} m"}"'


AnyObstacle = Annotated[
    HalfSpace | Ball | Capsule | Cylinder | Box,
    Field(discriminator="kind"),
    BeforeValidator(one_of("half-space", "sphere", "capsule", "cylinder", "box")),
]
