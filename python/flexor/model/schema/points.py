"""Points on bodies, and the elements attached to them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Discriminator, Tag, model_validator

from flexor.model import units
from flexor.model.schema.table import Choice, Index, Name, Switch, Table
from flexor.model.schema.vector import ForceVector, MomentVector, Offset
from flexor.model.units import NonNegativeLength, PositiveStiffness, PositiveStiffnessPerLength
from flexor.model.validation import describe, field_error


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


class Attachment(Station):
    """A point fixed to a body, at an offset from a station in its local frame."""

    offset: Offset = Offset()


class Ground(Table):
    """A point fixed in the world."""

    world: Offset


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
        for index, body in enumerate(self.bodies):
            if body in self.bodies[:index]:
                raise field_error(f"contains {describe(body)} twice", path="bodies")
        return self


class Contact(Table):
    """Contact (8) between all pairs of spheres of two groups.

    With ``shape = "round-cones"`` the bodies of the second group are solids: a link is a round
    cone from base to tip, a rod a chain of round cones between its sample points. The contact
    stiffness is ``stiffness`` per sphere of the first group or, against round cones only,
    ``stiffness_per_length`` of its rods.

    A group may be in contact with itself; pairs closer than ``skip`` in the group's order are then
    excluded. ``tip_spheres`` is the number of trailing spheres of the first group that contribute
    to F_t (14): by default one, or none for self-contact.
    """

    first: Name
    second: Name
    shape: Annotated[Literal["spheres", "round-cones"], Choice("spheres", "round-cones")] = (
        "spheres"
    )
    stiffness: PositiveStiffness | None = None
    stiffness_per_length: PositiveStiffnessPerLength | None = None
    skip: Index = 0
    tip_spheres: Index | None = None

    @model_validator(mode="after")
    def _check(self) -> Contact:
        if self.stiffness_per_length is None:
            if self.stiffness is None:
                raise field_error(f"is missing: {units.STIFFNESS.hint}", path="stiffness")
        elif self.stiffness is not None:
            raise field_error("has both stiffness and stiffness_per_length: give one")
        elif self.shape == "spheres":
            raise field_error('requires shape = "round-cones"', path="stiffness_per_length")
        return self


class Spring(Table):
    """A straight spring, or a tension-only strap (``slack``), between two points."""

    first: Attachment
    second: Anchor
    stiffness: PositiveStiffness
    rest_length: NonNegativeLength = units.LENGTH.si(0.0)
    slack: Switch = False


class Wrench(Attachment):
    """A force and a moment at a point of a body, fixed in the world or following the body.

    With ``input`` it is scaled by the load of the path.
    """

    force: ForceVector = ForceVector()
    moment: MomentVector = MomentVector()
    frame: Annotated[Literal["world", "body"], Choice("world", "body")] = "world"
    input: Switch = False
