"""Obstacles: what is fixed in the world and stops contact spheres."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from flexor.model.schema.joint import Axis
from flexor.model.schema.table import Choice, Name, Table
from flexor.model.schema.vector import Offset
from flexor.model.units import PositiveStiffness
from flexor.model.validation import field_error


class Obstacle(Table):
    """A fixed plane, ``kind = "half-space"``, that the spheres of some groups press on.

    Each sphere is pushed back along the normal with ``stiffness`` times its depth behind the plane.
    A round cone is deepest at one of its ends, so that spheres suffice for groups of round cones.
    """

    kind: Annotated[Literal["half-space"], Choice("half-space")]
    spheres: Annotated[tuple[Name, ...], Field(min_length=1)]
    point: Offset = Offset()
    normal: Axis
    stiffness: PositiveStiffness

    @model_validator(mode="after")
    def _check(self) -> Obstacle:
        if not any(self.normal):
            raise field_error("has no direction: it must not be zero", path="normal")
        for index, group in enumerate(self.spheres):
            if group in self.spheres[:index]:
                raise field_error(f'names the group "{group}" twice', path="spheres")
        return self
