"""Ties: joints between two places that close loops."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import model_validator

from flexor.model.schema.body import Link
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.force import Force
from flexor.model.schema.planar import about_y
from flexor.model.schema.points import Anchor, Ground
from flexor.model.schema.table import Choice
from flexor.model.schema.vector import Axis, Rotation, direction, shown
from flexor.model.units import DISPLACEMENT, ROTATION, Dimension
from flexor.model.validation import field_error

KINDS = ("weld", "pin", "hinge", "slider")
_DRIVEN = {
    "weld": ("displacement", "rotation"),
    "pin": ("displacement",),
    "hinge": ("rotation",),
    "slider": ("displacement",),
}


class Tie(Force):
    """A joint between two places of bodies, or of a body and the world, that closes a loop.

    A ``weld`` allows no relative motion, a ``pin`` any rotation, a ``hinge`` rotation about
    ``axis`` and a ``slider`` translation along it. The places of a weld, pin or hinge coincide.
    Relative to one another they are oriented as in the reference state, and turned by
    ``rotation``. With ``drive`` the load of the path prescribes the displacement of the second
    place along the axis, or its rotation about it. Directions are in the local frame of the first
    place, or in the world if that is its place.
    """

    description: ClassVar[str] = "ties"

    kind: Annotated[Literal["weld", "pin", "hinge", "slider"], Choice(*KINDS)]
    first: Anchor
    second: Anchor
    axis: Axis | None = None
    rotation: Rotation = Rotation()
    drive: Annotated[
        Literal["displacement", "rotation"] | None, Choice("displacement", "rotation")
    ] = None

    @model_validator(mode="after")
    def _check(self) -> Tie:
        if self.drive is not None and self.drive not in _DRIVEN[self.kind]:
            allowed = " or ".join(f'"{each}"' for each in _DRIVEN[self.kind])
            tail = f'is "{self.drive}": a {self.kind} can be driven by {allowed}'
            raise field_error(tail, path="drive")
        if self.axis is not None and not any(self.axis):
            raise field_error("is zero: it must have a direction", path="axis")
        if self.axis is not None and self.kind in ("weld", "pin") and self.drive is None:
            raise field_error(f"is given, but a {self.kind} without drive has none", path="axis")
        if self.kind == "pin" and any(self.rotation.components):
            raise field_error("is given, but a pin holds no rotation", path="rotation")
        return self

    @property
    def direction(self) -> list[float]:
        """Unit vector of its axis: y for rotations and x for translations, unless given."""
        turns = self.kind == "hinge" or self.drive == "rotation"
        axis = self.axis or ((0.0, 1.0, 0.0) if turns else (1.0, 0.0, 0.0))
        return direction(axis)

    @property
    def load(self) -> Dimension:
        """Dimension of its load, if it is driven."""
        return ROTATION if self.drive == "rotation" else DISPLACEMENT

    @property
    def holds_rotation(self) -> bool:
        """Whether it transmits a moment."""
        return self.kind != "pin"

    def check(self, path: str, system: BodySystem) -> None:
        """Check that both places exist, and that they can move relative to one another."""
        self.first.check_point(f"{path}.first", system.bodies)
        self.second.check_point(f"{path}.second", system.bodies)
        first, second = self.first, self.second
        if isinstance(first, Ground) and isinstance(second, Ground):
            tail = "is in the world, as first: one of two places that are tied is on a body"
            raise field_error(tail, path=f"{path}.second")
        if isinstance(first, Ground) or isinstance(second, Ground) or first.body != second.body:
            return
        same = first.lower_point(system.bodies) == second.lower_point(system.bodies)
        if same or isinstance(system.bodies[first.body], Link):
            what = "the same place" if same else "the same rigid link"
            tail = f'is on {what} as first: a tie joins two places, not "{first.body}" to itself'
            raise field_error(tail, path=f"{path}.second")

    def check_planar(self, path: str) -> None:
        """Reject places and rotations out of the plane, and an axis that is not in it or y."""
        self.first.check_planar(f"{path}.first")
        self.second.check_planar(f"{path}.second")
        about_y(self.rotation, f"{path}.rotation")
        if self.axis is None:
            return
        x, y, z = self.axis
        turns = self.kind == "hinge" or self.drive == "rotation"
        if turns and (x, z) != (0.0, 0.0):
            raise field_error(
                f"is {shown(self.axis)}: in a planar model it must be y", f"{path}.axis"
            )
        if not turns and y != 0.0:
            tail = f"is {shown(self.axis)}: in a planar model it must lie in the x-z plane"
            raise field_error(tail, f"{path}.axis")

    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the tie to the engine."""
        return {
            "name": name,
            "kind": self.kind,
            "first": self.first.lower_point(system.bodies),
            "second": self.second.lower_point(system.bodies),
            "axis": self.direction,
            "rotation": list(self.rotation.components),
            "drive": self.drive,
        }
