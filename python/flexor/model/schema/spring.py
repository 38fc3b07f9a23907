"""Springs and straps."""

from __future__ import annotations

from typing import Any, ClassVar

from flexor.model import units
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.force import Force
from flexor.model.schema.points import Anchor, Attachment
from flexor.model.schema.table import Switch
from flexor.model.units import NonNegativeLength, PositiveStiffness


class Spring(Force):
    """A straight spring, or a tension-only strap (``slack``), between two points."""

    description: ClassVar[str] = "springs"

    first: Attachment
    second: Anchor
    stiffness: PositiveStiffness
    rest_length: NonNegativeLength = units.LENGTH.si(0.0)
    slack: Switch = False

    def check(self, path: str, system: BodySystem) -> None:
        """Check that both ends exist."""
        self.first.check_point(f"{path}.first", system.bodies)
        self.second.check_point(f"{path}.second", system.bodies)

    def check_planar(self, path: str) -> None:
        """Reject ends outside the plane."""
        self.first.check_planar(f"{path}.first")
        self.second.check_planar(f"{path}.second")

    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the spring to the engine."""
        return {
            "name": name,
            "first": self.first.lower_point(system.bodies),
            "second": self.second.lower_point(system.bodies),
            "stiffness": float(self.stiffness),
            "rest_length": float(self.rest_length),
            "slack": self.slack,
        }
