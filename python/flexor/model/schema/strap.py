"""Straps from a rod to a body, anchored on their surfaces."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field, model_validator

from flexor.model import units
from flexor.model.schema.body import Rod
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.checks import check_rod
from flexor.model.schema.force import Force
from flexor.model.schema.points import Station
from flexor.model.schema.profile import surface
from flexor.model.schema.reference import reference_frames
from flexor.model.schema.table import Name, Number
from flexor.model.units import (
    NonNegativeForce,
    NonNegativeLength,
    PositiveForce,
    PositiveLength,
    PositiveStiffness,
    PositiveStiffnessPerLength,
)
from flexor.model.validation import describe, field_error

Fraction = Annotated[Number, Field(ge=0.0, le=1.0)]


class Strap(Force):
    """A strap that only pulls, from the underside of a rod to the back of a body.

    It is sewn to both surfaces: its ends follow the rod's S(X) and the body's radius. In the
    reference state it has the tension ``pretension``, or is longer than the distance of its ends by
    ``slack``. Its stiffness is given, or is that of its ``width`` times ``stiffness_per_width``.
    """

    description: ClassVar[str] = "springs"

    rod: Name
    at: Fraction
    to: Station
    stiffness: PositiveStiffness | None = None
    width: PositiveLength | None = None
    stiffness_per_width: PositiveStiffnessPerLength | None = None
    pretension: NonNegativeForce = units.FORCE.si(0.0)
    slack: NonNegativeLength = units.LENGTH.si(0.0)
    limit: PositiveForce | None = None

    @model_validator(mode="after")
    def _check(self) -> Strap:
        whole = self.width is not None and self.stiffness_per_width is not None
        if (self.stiffness is None) != whole:
            tail = "is missing: give it, or width and stiffness_per_width"
            if self.stiffness is not None:
                tail = "is given as well as width and stiffness_per_width: give one"
            raise field_error(tail, path="stiffness")
        if self.pretension > 0.0 and self.slack > 0.0:
            raise field_error("is given as well as pretension: a strap has one of them", "slack")
        return self

    @property
    def constant(self) -> float:
        """Its stiffness [N/m]."""
        if self.stiffness is not None:
            return float(self.stiffness)
        assert self.width is not None and self.stiffness_per_width is not None
        return float(self.width) * float(self.stiffness_per_width)

    def check(self, path: str, system: BodySystem) -> None:
        """Check that both ends exist and that the strap is long enough for its pretension."""
        check_rod(self.rod, system.bodies, f"{path}.rod")
        if system.rod(self.rod).point_at(self.at) is None:
            elements = system.rod(self.rod).elements
            tail = f"is {self.at}: it must be an element boundary, a multiple of 1/{elements}"
            raise field_error(tail, path=f"{path}.at")
        self.to.check_point(f"{path}.to", system.bodies)
        if self._rest(system) < 0.0:
            tail = f"is {describe(getattr(self.pretension, 'text', self.pretension))}: it must not "
            tail += f"stretch the strap to more than the {1e3 * self._distance(system):.4g} mm "
            raise field_error(f"{tail}between its ends", path=f"{path}.pretension")

    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the strap to the engine, as a spring that may be slack."""
        first = Station(body=self.rod, at=self.at).lower_point(system.bodies)
        second = self.to.lower_point(system.bodies)
        first["surface"], second["surface"] = [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]
        return {
            "name": name,
            "first": first,
            "second": second,
            "stiffness": self.constant,
            "rest_length": self._rest(system),
            "slack": True,
        }

    def _rest(self, system: BodySystem) -> float:
        return self._distance(system) + self.slack - self.pretension / self.constant

    def _distance(self, system: BodySystem) -> float:
        """Distance of the ends in the reference state [m]."""
        frames = reference_frames(system.bodies)
        first = _surface_point(system, frames, self.rod, self.at, -1.0)
        second = _surface_point(system, frames, self.to.body, self.fraction(system), 1.0)
        return float(np.linalg.norm(first - second))

    def fraction(self, system: BodySystem) -> float:
        """Return where on the body it is sewn, as a fraction of its length."""
        body = system.bodies[self.to.body]
        if self.to.point is not None and isinstance(body, Rod):
            return float(body.sample_points[self.to.point])
        if self.to.at == "centroid":
            assert not isinstance(body, Rod)
            a, b = float(body.radius.base), float(body.radius.tip)
            return (a * a + 2 * a * b + 3 * b * b) / (4 * (a * a + a * b + b * b))
        return float({"base": 0.0, "tip": 1.0}.get(str(self.to.at), self.to.at))  # type: ignore[arg-type]


def _surface_point(
    system: BodySystem, frames: dict[str, Any], name: str, fraction: float, side: float
) -> Any:
    """Return the point of a body's surface above (1) or below (-1) its axis [m]."""
    body = system.bodies[name]
    if isinstance(body, Rod):
        radius = float(surface(body.radius, np.array([fraction]))[0][0])
    else:
        radius = float(body.radius.base) + fraction * (body.radius.tip - body.radius.base)
    frame = frames[name](fraction)
    return frame[:3, 3] + side * radius * frame[:3, 2]
