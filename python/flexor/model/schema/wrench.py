"""Point loads."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.force import Force
from flexor.model.schema.planar import about_y, in_plane
from flexor.model.schema.points import Attachment
from flexor.model.schema.table import Choice, Switch
from flexor.model.schema.vector import ForceVector, MomentVector
from flexor.model.units import FORCE, LOAD_FACTOR, MOMENT, Dimension


class Wrench(Attachment, Force):
    """A force and a moment at a point of a body, fixed in the world or following the body.

    With ``input`` it is scaled by the load of the path.
    """

    description: ClassVar[str] = "wrenches"

    force: ForceVector = ForceVector()
    moment: MomentVector = MomentVector()
    frame: Annotated[Literal["world", "body"], Choice("world", "body")] = "world"
    input: Switch = False

    @property
    def load(self) -> Dimension:
        """Dimension of its load: a force or moment if the vector has length one, else a factor."""
        lengths = (math.hypot(*each.components) for each in (self.force, self.moment))
        force, moment = (round(length, 12) for length in lengths)  # of a turned vector, too
        return {(1.0, 0.0): FORCE, (0.0, 1.0): MOMENT}.get((force, moment), LOAD_FACTOR)

    def check(self, path: str, system: BodySystem) -> None:
        """Check that the point exists."""
        self.check_point(path, system.bodies)

    def check_planar(self, path: str) -> None:
        """Reject a point or a force outside the plane, and a moment that is not about y."""
        super().check_planar(path)
        in_plane(self.force, f"{path}.force")
        about_y(self.moment, f"{path}.moment")

    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the wrench to the engine."""
        return {
            "name": name,
            "at": self.lower_point(system.bodies),
            "force": list(self.force.components),
            "moment": list(self.moment.components),
            "frame": self.frame,
            "input": self.input,
        }
