"""Places on bodies, and what is attached there."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Discriminator, Tag, model_validator

from flexor.model import units
from flexor.model.fault import fault, shown
from flexor.model.schema.table import Choice, Index, Name, Switch, Table
from flexor.model.schema.vector import ForceVector, MomentVector, Offset
from flexor.model.units import NonNegativeLength, PositiveStiffness, PositiveStiffnessPerLength


def _at(value: object) -> object:
    if isinstance(value, (int, float)) and not isinstance(value, bool) and 0.0 <= value <= 1.0:
        return float(value)
    if value not in ("base", "tip", "centroid"):
        allowed = 'allowed are "base", "tip", "centroid" or a fraction from 0 to 1'
        raise fault(f"is {shown(value)}: {allowed}")
    return value


class Station(Table):
    """A place along a body.

    ``at`` is ``"base"``, ``"tip"``, ``"centroid"`` (of a link) or a fraction of the length; on a
    rod it must be one of the sample points, which ``point`` counts from 0.
    """

    body: Name
    at: Annotated[Literal["base", "tip", "centroid"] | float | None, BeforeValidator(_at)] = None
    point: Index | None = None

    @model_validator(mode="after")
    def _check(self) -> Station:
        if (self.at is None) == (self.point is None):
            raise fault('needs either at (such as "tip") or point (of a rod)')
        return self


class Attachment(Station):
    """A place on a body, shifted within the frame there."""

    offset: Offset = Offset()


class Ground(Table):
    """A place fixed in the world."""

    world: Offset


def _form(value: object) -> str:
    ground = isinstance(value, Ground) or (isinstance(value, dict) and "world" in value)
    return "ground" if ground else "attachment"


Anchor = Annotated[
    Annotated[Attachment, Tag("attachment")] | Annotated[Ground, Tag("ground")],
    Discriminator(_form),
]


class SphereGroup(Table):
    """Contact spheres, as wide as the bodies they sit on.

    Each of ``bodies`` gets the paper's layout: a rod one sphere at its joint frame and one at every
    sample point (so its base counts twice), a link one at its joint frame and one at its centroid.
    ``points`` adds single ones.
    """

    bodies: tuple[Name, ...] = ()
    points: tuple[Station, ...] = ()

    @model_validator(mode="after")
    def _check(self) -> SphereGroup:
        if not self.bodies and not self.points:
            raise fault("is on no body: give bodies or points")
        for index, body in enumerate(self.bodies):
            if body in self.bodies[:index]:
                raise fault(f"names the body {shown(body)} twice", path="bodies")
        return self


class Contact(Table):
    """Contact (8) between every sphere of one group and every sphere of another.

    With ``shape = "round-cones"`` the second group's bodies are solid: a link is a round cone from
    base to tip, a rod a chain of them from sample point to sample point. Each sphere of the first
    group is as stiff as ``stiffness``; or, against round cones only, each piece of its rods' length
    as ``stiffness_per_length``.

    A group may touch itself; pairs closer than ``skip`` in the group's order are then left out.
    ``tip_spheres`` says how many of the first group's last spheres make up F_t (14); unless given
    it is one, and none where a group touches itself.
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
                raise fault(f"is missing: {units.STIFFNESS.hint}", path="stiffness")
        elif self.stiffness is not None:
            raise fault("has both stiffness and stiffness_per_length: give one")
        elif self.shape == "spheres":
            raise fault('is only for shape = "round-cones"', path="stiffness_per_length")
        return self


class Spring(Table):
    """A straight spring, or a strap that only pulls (``slack``), between two places."""

    first: Attachment
    second: Anchor
    stiffness: PositiveStiffness
    rest_length: NonNegativeLength = units.LENGTH.si(0.0)
    slack: Switch = False


class Wrench(Attachment):
    """A force and a moment at a place on a body, fixed in the world or turning with the body.

    With ``input`` it is multiplied by the load that a path steps through.
    """

    force: ForceVector = ForceVector()
    moment: MomentVector = MomentVector()
    frame: Annotated[Literal["world", "body"], Choice("world", "body")] = "world"
    input: Switch = False
