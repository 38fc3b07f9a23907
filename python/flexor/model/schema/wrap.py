"""Wraps: spheres and cylinders around which tendons pass."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import model_validator

from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.force import Force
from flexor.model.schema.obstacle import Place
from flexor.model.schema.planar import in_plane
from flexor.model.schema.points import Attachment
from flexor.model.schema.table import Choice
from flexor.model.schema.vector import Axis, direction, shown
from flexor.model.units import PositiveLength
from flexor.model.validation import field_error


class Wrap(Force):
    """A sphere, or an endless cylinder along ``axis``, around which tendons pass.

    ``point`` is its centre, in the world or on a body, which then carries it. In a planar model
    both are circles.
    """

    description: ClassVar[str] = "wraps"

    kind: Annotated[Literal["sphere", "cylinder"], Choice("sphere", "cylinder")]
    point: Place
    radius: PositiveLength
    axis: Axis | None = None

    @model_validator(mode="after")
    def _check(self) -> Wrap:
        if self.kind == "sphere" and self.axis is not None:
            raise field_error("is given, but a sphere has none", path="axis")
        if self.axis is not None and not any(self.axis):
            raise field_error("is zero: it must have a direction", path="axis")
        return self

    @property
    def direction(self) -> list[float] | None:
        """Unit vector along a cylinder, y unless given; none for a sphere."""
        return None if self.kind == "sphere" else direction(self.axis or (0.0, 1.0, 0.0))

    def check(self, path: str, system: BodySystem) -> None:
        """Check that its point exists."""
        if isinstance(self.point, Attachment):
            self.point.check_point(f"{path}.point", system.bodies)

    def check_planar(self, path: str) -> None:
        """Reject a centre out of the plane, and a cylinder that is not across it."""
        if isinstance(self.point, Attachment):
            self.point.check_planar(f"{path}.point")
        else:
            in_plane(self.point, f"{path}.point")
        if self.axis is not None and (self.axis[0], self.axis[2]) != (0.0, 0.0):
            raise field_error(
                f"is {shown(self.axis)}: in a planar model it must be y", f"{path}.axis"
            )

    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the wrap to the engine."""
        if isinstance(self.point, Attachment):
            at = self.point.lower_point(system.bodies)
        else:
            at = {"world": list(self.point.components)}
        described = {"name": name, "at": at, "radius": float(self.radius)}
        return described if self.direction is None else {**described, "axis": self.direction}
