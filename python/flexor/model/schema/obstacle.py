"""Obstacles: planes fixed in the world that contact spheres press on."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.checks import check_known
from flexor.model.schema.force import Force
from flexor.model.schema.planar import in_plane
from flexor.model.schema.table import Choice, Name
from flexor.model.schema.vector import Axis, Offset, direction
from flexor.model.units import PositiveStiffness
from flexor.model.validation import field_error, first_repeated


class Obstacle(Force):
    """A fixed plane, ``kind = "half-space"``, that the spheres of some groups press on.

    Each sphere is pushed back along the normal with ``stiffness`` times its depth behind the plane.
    A round cone is deepest at one of its ends, so that spheres suffice for groups of round cones.
    """

    description: ClassVar[str] = "half_spaces"

    kind: Annotated[Literal["half-space"], Choice("half-space")]
    spheres: Annotated[tuple[Name, ...], Field(min_length=1)]
    point: Offset = Offset()
    normal: Axis
    stiffness: PositiveStiffness

    @model_validator(mode="after")
    def _check(self) -> Obstacle:
        if not any(self.normal):
            raise field_error("has no direction: it must not be zero", path="normal")
        if (group := first_repeated(self.spheres)) is not None:
            raise field_error(f'names the group "{group}" twice', path="spheres")
        return self

    def check(self, path: str, system: BodySystem) -> None:
        """Check that the groups exist."""
        for group in self.spheres:
            check_known(group, "sphere group", system.spheres, f"{path}.spheres")

    def check_planar(self, path: str) -> None:
        """Reject a plane that is not normal to the model's."""
        in_plane(self.point, f"{path}.point")
        if self.normal[1] != 0.0:
            tail = "in a planar model it must lie in the x-z plane"
            raise field_error(f"is {list(self.normal)}: {tail}", f"{path}.normal")

    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the half-space to the engine."""
        return {
            "name": name,
            "spheres": list(self.spheres),
            "point": list(self.point.components),
            "normal": direction(self.normal),
            "stiffness": float(self.stiffness),
        }
