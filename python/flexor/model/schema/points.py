"""Points on bodies, points in the world and groups of spheres."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Tag, model_validator

from flexor.model.schema.body import Body, Link, Rod
from flexor.model.schema.checks import check_known
from flexor.model.schema.planar import in_plane
from flexor.model.schema.table import Index, Name, Table
from flexor.model.schema.vector import Offset
from flexor.model.validation import describe, field_error, first_repeated


def _at(value: object) -> object:
    if isinstance(value, (int, float)) and not isinstance(value, bool) and 0.0 <= value <= 1.0:
        return float(value)
    if value not in ("base", "tip", "centroid"):
        allowed = 'expected "base", "tip", "centroid" or a fraction from 0 to 1'
        raise field_error(f"is {describe(value)}: {allowed}")
    return value


class Station(Table):
    """A point along a body.

    ``at`` is ``"base"``, ``"tip"``, ``"centroid"`` (of a link) or a fraction of the length, which
    must be an element boundary of a rod. ``point`` is the index of a rod's sample point.
    """

    body: Name
    at: Annotated[Literal["base", "tip", "centroid"] | float | None, BeforeValidator(_at)] = None
    point: Index | None = None

    @model_validator(mode="after")
    def _check(self) -> Station:
        if (self.at is None) == (self.point is None):
            raise field_error('needs either at (such as "tip") or point (of a rod)')
        return self

    def check_point(self, path: str, bodies: Mapping[str, Body]) -> None:
        """Check that the body exists and has such a point."""
        check_known(self.body, "body", bodies, f"{path}.body")
        body, name = bodies[self.body], self.body
        if isinstance(body, Link):
            if self.point is not None:
                tail = f'is {self.point}: only rods have points, and "{name}" is a link'
                raise field_error(tail, path=f"{path}.point")
        elif self.at == "centroid":
            tail = f'is "centroid": only links support it, and "{name}" is a rod'
            raise field_error(tail, path=f"{path}.at")
        elif self.point is not None:
            if self.point >= body.sample_count:
                tail = f'is {self.point}: the points of "{name}" are 0 to {body.sample_count - 1}'
                raise field_error(tail, path=f"{path}.point")
        elif isinstance(self.at, float) and body.point_at(self.at) is None:
            tail = f'is {self.at!r}: on the rod "{name}" it must be a multiple of 1/{body.elements}'
            raise field_error(f"{tail} (an element boundary)", path=f"{path}.at")

    def lower_point(self, bodies: Mapping[str, Body]) -> dict[str, Any]:
        """Describe the point to the engine."""
        return {"body": self.body, "station": self._station(bodies[self.body])}

    def _station(self, body: Body) -> Any:
        if self.at == "centroid":
            return "centroid"
        if self.point is not None:
            return {"point": self.point}
        assert self.at is not None
        fraction = float({"base": 0.0, "tip": 1.0}.get(str(self.at), self.at))
        return (
            {"point": body.point_at(fraction)} if isinstance(body, Rod) else {"fraction": fraction}
        )


class Attachment(Station):
    """A point fixed to a body, at an offset from a station in its local frame."""

    offset: Offset = Offset()

    def check_planar(self, path: str) -> None:
        """Reject an offset out of the plane."""
        in_plane(self.offset, f"{path}.offset")

    def lower_point(self, bodies: Mapping[str, Body]) -> dict[str, Any]:
        """Describe the point to the engine."""
        return {**super().lower_point(bodies), "offset": list(self.offset.components)}


class Ground(Table):
    """A point fixed in the world."""

    world: Offset

    def check_point(self, path: str, bodies: Mapping[str, Body]) -> None:
        """Accept any point."""

    def check_planar(self, path: str) -> None:
        """Reject a point outside the plane."""
        in_plane(self.world, f"{path}.world")

    def lower_point(self, bodies: Mapping[str, Body]) -> dict[str, Any]:
        """Describe the point to the engine."""
        return {"world": list(self.world.components)}


def _form(value: object) -> str:
    ground = isinstance(value, Ground) or (isinstance(value, dict) and "world" in value)
    return "ground" if ground else "attachment"


Anchor = Annotated[
    Annotated[Attachment, Tag("attachment")] | Annotated[Ground, Tag("ground")],
    Discriminator(_form),
]


class SphereGroup(Table):
    """Contact spheres with the radii of the bodies at their centres.

    Each of ``bodies`` gets the paper's layout: a rod has one sphere at its joint frame and one at
    every sample point (so there are two at its base), a link one at its joint frame and one at its
    centroid. ``points`` adds individual spheres.
    """

    bodies: tuple[Name, ...] = ()
    points: tuple[Station, ...] = ()

    @model_validator(mode="after")
    def _check(self) -> SphereGroup:
        if not self.bodies and not self.points:
            raise field_error("is empty: give bodies or points")
        if (body := first_repeated(self.bodies)) is not None:
            raise field_error(f"contains {describe(body)} twice", path="bodies")
        return self

    def check(self, path: str, bodies: Mapping[str, Body]) -> None:
        """Check that the bodies and points exist."""
        for body in self.bodies:
            check_known(body, "body", bodies, f"{path}.bodies")
        for index, station in enumerate(self.points):
            station.check_point(f"{path}.points[{index}]", bodies)

    def lower(self, bodies: Mapping[str, Body], solid: bool = False) -> list[dict[str, Any]]:
        """Describe the spheres to the engine; links of a ``solid`` group have one at both ends."""
        spheres: list[dict[str, Any]] = []
        for name in self.bodies:
            body = bodies[name]
            if isinstance(body, Rod):
                stations: list[Any] = [{"point": 0}]
                stations += [{"point": index} for index in range(body.sample_count)]
            else:
                stations = [{"fraction": 0.0}, {"fraction": 1.0} if solid else "centroid"]
            spheres += [{"body": name, "station": station} for station in stations]
        return spheres + [station.lower_point(bodies) for station in self.points]
