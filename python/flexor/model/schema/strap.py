"""Straps from a rod to a body, anchored on their surfaces."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Discriminator, Field, Tag, model_validator

from flexor.arrays import Array
from flexor.model import units
from flexor.model.schema.body import Link, Rod
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.checks import check_known, check_rod
from flexor.model.schema.force import Force
from flexor.model.schema.loop_gap import gaps
from flexor.model.schema.points import Station
from flexor.model.schema.profile import surface
from flexor.model.schema.table import Name, Number, Switch, Table
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


class Loop(Table):
    """The end of a strap that loops around a link and slides along it."""

    body: Name
    loop: Literal[True]


def _form(value: object) -> str:
    looped = isinstance(value, Loop) or (isinstance(value, dict) and "loop" in value)
    return "loop" if looped else "sewn"


class Strap(Force):
    """A strap that only pulls, from the underside of a rod to the back of a body.

    It is sewn to both surfaces: its ends follow the rod's S(X) and the body's radius. Or it is a
    `Loop`, which holds the rod at the place of the link that is nearest. In the reference state it
    has the tension ``pretension``, or is longer than the distance of its ends by ``slack``. Its
    stiffness is given, or is that of its ``width`` times ``stiffness_per_width``. ``at`` is any
    fraction of the rod's length; with ``moving`` the engine can move it, as in searches that vary
    it, also from an element boundary.
    """

    description: ClassVar[str] = "springs"

    rod: Name
    at: Fraction
    moving: Switch = False
    to: Annotated[
        Annotated[Station, Tag("sewn")] | Annotated[Loop, Tag("loop")], Discriminator(_form)
    ]
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
        if isinstance(self.to, Loop):
            if system.rod(self.rod).point_at(self.at) is None:
                elements = system.rod(self.rod).elements
                tail = f"is {self.at}: that of a loop must be an element boundary, a multiple of "
                raise field_error(f"{tail}1/{elements}", path=f"{path}.at")
            if self.moving:
                raise field_error("is given, but a loop stays where it is", path=f"{path}.moving")
            check_known(self.to.body, "body", system.bodies, f"{path}.to.body")
            if isinstance(system.bodies[self.to.body], Rod):
                tail = f'is "{self.to.body}", which is a rod: a loop slides along a link'
                raise field_error(tail, path=f"{path}.to.body")
            return
        self.to.check_point(f"{path}.to", system.bodies)
        if self._rest(system) < 0.0:
            tail = f"is {describe(getattr(self.pretension, 'text', self.pretension))}: it must not "
            tail += f"stretch the strap to more than the {1e3 * self.distance(system):.4g} mm "
            raise field_error(f"{tail}between its ends", path=f"{path}.pretension")

    def listed(self) -> str:
        """Return the list of the engine's description that it belongs to."""
        return "loops" if isinstance(self.to, Loop) else self.description

    def group(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the spheres of a loop: of its point of the rod and of both ends of the link."""
        first = Station(body=self.rod, at=self.at).lower_point(system.bodies)
        ends = [{"body": self.to.body, "station": {"fraction": end}} for end in (0.0, 1.0)]
        return {"name": f"{name}.loop", "spheres": [first, *ends]}

    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the strap to the engine, as a spring that may be slack, or as a loop."""
        if isinstance(self.to, Loop):
            return {
                "name": name,
                "spheres": f"{name}.loop",
                "stiffness": self.constant,
                "rest_length": self._rest(system),
            }
        if self.moving or system.rod(self.rod).point_at(self.at) is None:
            first: dict[str, Any] = {"body": self.rod, "station": {"along": float(self.at)}}
        else:
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
        return self.distance(system) + self.slack - self.pretension / self.constant

    def distance(self, system: BodySystem) -> float:
        """Distance of the ends in the reference state [m]; negative where a loop's overlap."""
        found = self.ends(system)
        if not isinstance(self.to, Loop):
            return float(np.linalg.norm(found))
        return float(gaps(found[None])[0]) - self.thickness(system)

    def ends(self, system: BodySystem) -> Array:
        """Return what the distance of its ends follows from.

        That is the vector between them (3,) [m], or of a loop the row (6,) of `gaps`.
        """
        frames = system.reference_frames
        if isinstance(self.to, Loop):
            link = system.bodies[self.to.body]
            assert isinstance(link, Link)
            base, point = frames[self.to.body](0.0), frames[self.rod](self.at)[:3, 3]
            sizes = (link.radius.base, link.radius.tip, link.length)
            return np.array([*(base[:3, :3].T @ (point - base[:3, 3])), *map(float, sizes)])
        first = _surface_point(system, frames, self.rod, self.at, -1.0)
        second = _surface_point(system, frames, self.to.body, self.fraction(system), 1.0)
        return np.asarray(first - second)

    def thickness(self, system: BodySystem) -> float:
        """Distance of the rod's axis from its surface at the place of a loop [m]."""
        return float(surface(system.rod(self.rod).radius, np.array([self.at]))[0][0])

    def fraction(self, system: BodySystem) -> float:
        """Return the place on the body where it is sewn, as a fraction of the length."""
        assert isinstance(self.to, Station)
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
