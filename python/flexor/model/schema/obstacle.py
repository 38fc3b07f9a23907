"""Obstacles: what bodies with a skin or contact spheres press on, in the world or on a body."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Discriminator, Field, Tag, model_validator

from flexor.arrays import Array
from flexor.model.schema.body import Rod
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.checks import check_known, check_ratio
from flexor.model.schema.force import Force
from flexor.model.schema.foundation import are_related, part_of
from flexor.model.schema.planar import in_plane
from flexor.model.schema.points import Attachment
from flexor.model.schema.skin import Skin
from flexor.model.schema.table import Name, NonNegativeNumber, PositiveNumber
from flexor.model.schema.touched import lower_touch
from flexor.model.schema.vector import Axis, Offset, Triple, direction
from flexor.model.units import PositiveStiffness
from flexor.model.validation import field_error, first_repeated


def _form(value: object) -> str:
    on_body = isinstance(value, Attachment) or (isinstance(value, Mapping) and "body" in value)
    return "attachment" if on_body else "world"


Place = Annotated[
    Annotated[Offset, Tag("world")] | Annotated[Attachment, Tag("attachment")],
    Discriminator(_form),
]


class Obstacle(Force):
    """Something solid that bodies press on.

    All bodies with a skin do, through it and the obstacle's own ``skin``; without one the obstacle
    is rigid. With ``spheres`` only those of these groups do: each is pushed back along the normal
    of the surface with ``stiffness`` times its depth. ``point`` is the obstacle's origin: in the
    world, or on a body, which then carries it.
    ``friction`` and ``stiffness_ratio`` are as for a contact.
    """

    description: ClassVar[str] = "obstacles"

    kind: str
    spheres: Annotated[tuple[Name, ...], Field(min_length=1)] | None = None
    point: Place = Offset()
    stiffness: PositiveStiffness | None = None
    skin: Skin | None = None
    friction: NonNegativeNumber = 0.0
    stiffness_ratio: PositiveNumber | None = None

    @model_validator(mode="after")
    def _check_groups(self) -> Obstacle:
        check_ratio(self.friction, self.stiffness_ratio)
        if self.spheres is None and self.stiffness is not None:
            tail = 'is of no use without spheres: name groups of them, or give a "skin" instead'
            raise field_error(tail, path="stiffness")
        if self.spheres is not None and self.stiffness is None:
            tail = 'is missing: spheres press on it with a stiffness, such as "5 N/mm"'
            raise field_error(tail, path="stiffness")
        if self.spheres is not None and self.skin is not None:
            raise field_error("does not act on spheres: leave out one of both", path="skin")
        if (group := first_repeated(self.spheres or ())) is not None:
            raise field_error(f'names the group "{group}" twice', path="spheres")
        return self

    def skins(self, name: str, system: BodySystem) -> list[str]:
        """Return the bodies that press on it, of this name, with their skins.

        Those are of its own part, of its parts and of the models that it is a part of.
        """
        if self.spheres is not None:
            return []
        own = self.point.body if isinstance(self.point, Attachment) else None
        return [
            body
            for body, each in system.bodies.items()
            if each.skin is not None and body != own and are_related(part_of(name), part_of(body))
        ]

    @abstractmethod
    def excludes(self, rod: Rod, touching: bool) -> bool:
        """Whether a rod, which touches it or not, must not begin in it."""

    @property
    def is_curved(self) -> bool:
        """Whether it is round."""
        return False

    @property
    def half_width(self) -> float:
        """Half of its smallest extent [m]; infinite where it has no other side."""
        return math.inf

    @property
    def line(self) -> Triple | None:
        """Direction in which a round one is straight, in the world or the frame of its body."""
        return None

    @property
    def turn(self) -> Triple:
        """Rotation vector of its axes relative to the world or the frame of its body [rad]."""
        return (0.0, 0.0, 0.0)

    @property
    def axes(self) -> Array:
        """Its axes in the world or the frame of its body, the columns (3, 3)."""
        return turning(self.turn)

    @abstractmethod
    def distance(self, place: Array) -> Array:
        """Return how far places (..., 3) in its axes are from its surface [m]; negative in it."""

    @abstractmethod
    def surfaces(self, planar: bool) -> list[dict[str, Any]]:
        """Describe its surfaces to the engine."""

    def check(self, path: str, system: BodySystem) -> None:
        """Check that something touches it, that moves by itself, and that no rod begins in it."""
        name = path.partition(".")[2]
        if self.spheres is None and not self.skins(name, system):
            tail = "touches nothing: no body has a skin, and it names no spheres"
            raise field_error(f"{tail}: give a body a skin, or the obstacle spheres", path)
        for group in self.spheres or ():
            check_known(group, "sphere group", system.spheres, f"{path}.spheres")
        if isinstance(self.point, Attachment):
            self.point.check_point(f"{path}.point", system.bodies)
            for group in self.spheres or ():
                if self.point.body in _bodies(system, group):
                    tail = f'names the group "{group}", which has spheres on "{self.point.body}"'
                    raise field_error(f"{tail}, the body that carries it", f"{path}.spheres")
        self._check_bases(path, system)

    def _check_bases(self, path: str, system: BodySystem) -> None:
        """Check that it contains the base of no rod that it has to stay clear of."""
        touching = {body for group in self.spheres or () for body in _bodies(system, group)}
        touching |= set(self.skins(path.partition(".")[2], system))
        origin, axes = self.reference_pose(system)
        for name, body in system.bodies.items():
            carrier = isinstance(self.point, Attachment) and self.point.body == name
            if carrier or not isinstance(body, Rod) or not self.excludes(body, name in touching):
                continue
            base = system.reference_frames[name](0.0)[:3, 3]
            if self.distance(axes.T @ (base - origin)) < 0.0:
                where = ", ".join(f"{100.0 * x + 0.0:.4g}" for x in base)
                tail = f'contains the base of "{name}" at rest, which is at ({where}) cm'
                raise field_error(f"{tail}: move the obstacle or the rod", path)

    def check_planar(self, path: str) -> None:
        """Reject an origin outside the plane."""
        if isinstance(self.point, Attachment):
            self.point.check_planar(f"{path}.point")
        else:
            in_plane(self.point, f"{path}.point")

    def reference_pose(self, system: BodySystem) -> tuple[Array, Array]:
        """Return its origin [m] and its axes, the columns (3, 3), in the reference state."""
        if not isinstance(self.point, Attachment):
            return np.array(self.point.components, dtype=float), self.axes
        frame = self._carrier(system)
        offset = np.array(self.point.offset.components, dtype=float)
        return frame[:3, 3] + frame[:3, :3] @ offset, frame[:3, :3] @ self.axes

    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the obstacle to the engine."""
        if isinstance(self.point, Attachment):
            at = self.point.lower_point(system.bodies)
        else:
            at = {"world": list(self.point.components)}
        described = {
            "name": name,
            "spheres": list(self.spheres or ()),
            "at": at,
            "rotation": list(self.turn),
            "surfaces": self.surfaces(system.planar),
            "stiffness": float(self.stiffness or 0.0),
        }
        if touching := self.skins(name, system):
            axis = None if self.line is None else self._carrier(system)[:3, :3] @ self.line
            described["skins"] = [
                lower_touch(body, system, self.skin, axis, self.is_curved) for body in touching
            ]
        return described

    def _carrier(self, system: BodySystem) -> Array:
        """Return the pose (4, 4) of what carries it in the reference state."""
        if not isinstance(self.point, Attachment):
            return np.eye(4)
        return system.reference_frames[self.point.body](_fraction(self.point, system))


class HalfSpace(Obstacle):
    """A half-space, ``kind = "half-space"``, behind a plane through ``point``.

    A round cone is deepest in it at one of its ends, so that spheres suffice for groups of round
    cones.
    """

    kind: Literal["half-space"]
    normal: Axis

    @model_validator(mode="after")
    def _check(self) -> HalfSpace:
        if not any(self.normal):
            raise field_error("has no direction: it must not be zero", path="normal")
        return self

    def check_planar(self, path: str) -> None:
        """Reject a plane that is not normal to the model's."""
        super().check_planar(path)
        if self.normal[1] != 0.0:
            tail = "in a planar model it must lie in the x-z plane"
            raise field_error(f"is {list(self.normal)}: {tail}", f"{path}.normal")

    def excludes(self, rod: Rod, touching: bool) -> bool:
        """Whether the rod touches it and its base is fixed in the world."""
        return touching and rod.parent is None and rod.joint.kind == "fixed"

    def distance(self, place: Array) -> Array:
        """Return how far places are in front of the plane [m]."""
        return np.asarray(place @ np.array(direction(self.normal)))

    def surfaces(self, planar: bool) -> list[dict[str, Any]]:
        """Describe the plane to the engine."""
        return [{"plane": {"normal": direction(self.normal), "distance": 0.0}}]


def turning(rotation: Triple) -> Array:
    """Return the matrix (3, 3) of a rotation vector [rad], by Rodrigues' formula."""
    angle = float(np.linalg.norm(rotation))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = np.array(rotation) / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross)


def _bodies(system: BodySystem, group: str) -> set[str]:
    found = system.spheres[group]
    return {*found.bodies, *(point.body for point in found.points)}


def _fraction(point: Attachment, system: BodySystem) -> float:
    """Return where a point is along its body, as a share of the length."""
    body = system.bodies[point.body]
    if isinstance(body, Rod):
        return float(body.sample_points[point.lower_point(system.bodies)["station"]["point"]])
    if point.at == "centroid":
        a, b = float(body.radius.base), float(body.radius.tip)
        return (a**2 + 2.0 * a * b + 3.0 * b**2) / (4.0 * (a**2 + a * b + b**2))
    return float({"base": 0.0, "tip": 1.0}.get(str(point.at), point.at or 0.0))
