"""Joints that move together, such as those of a finger's end."""

from __future__ import annotations

from typing import Any, ClassVar

from flexor.model import units
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.force import Force
from flexor.model.schema.table import Name, Number, Text
from flexor.model.schema.torque import chosen_angle
from flexor.model.units import Angle, AngularStiffness
from flexor.model.validation import field_error


class Coupling(Force):
    """A spring that turns the joint of one body with that of another: ½ k (θ₂ - r θ₁ - θ₀)².

    r is ``ratio``, θ₀ ``offset``, k ``stiffness``: of the ligaments and tendons that couple them.
    """

    description: ClassVar[str] = "joint_couplings"

    first: Name
    second: Name
    first_coordinate: Text | None = None
    second_coordinate: Text | None = None
    ratio: Number
    offset: Angle = units.ANGLE.si(0.0)
    stiffness: AngularStiffness

    def check(self, path: str, system: BodySystem) -> None:
        """Check that both bodies have joints with such angles, and that these differ."""
        found = [(body, self._angle(end, path, system)) for end, body in self._ends.items()]
        if found[0] == found[1]:
            raise field_error(f'is "{self.second}", as first: two joints differ', f"{path}.second")

    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the coupling to the engine."""
        return {
            "name": name,
            "bodies": [self.first, self.second],
            "coordinates": [self._angle(end, name, system) for end in self._ends],
            "ratio": self.ratio,
            "offset": float(self.offset),
            "stiffness": float(self.stiffness),
        }

    @property
    def _ends(self) -> dict[str, str]:
        return {"first": self.first, "second": self.second}

    def _angle(self, end: str, path: str, system: BodySystem) -> str:
        name = f"{end}_coordinate"
        paths = (f"{path}.{end}", f"{path}.{name}")
        return chosen_angle(self._ends[end], getattr(self, name), paths, system)
