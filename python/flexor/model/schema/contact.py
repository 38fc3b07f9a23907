"""Contact between groups of spheres, or between spheres and round cones."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from flexor.model import units
from flexor.model.schema.body import Body, Rod
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.checks import check_known, check_ratio, check_rod
from flexor.model.schema.force import Force
from flexor.model.schema.points import SphereGroup
from flexor.model.schema.table import Choice, Index, Name, NonNegativeNumber, PositiveNumber
from flexor.model.units import PositiveStiffness, PositiveStiffnessPerLength
from flexor.model.validation import field_error


class Contact(Force):
    """Contact (8) between all pairs of spheres of two groups.

    With ``shape = "round-cones"`` the bodies of the second group are solids: a link is a round
    cone from base to tip, a rod a chain of round cones between its sample points. The contact
    stiffness is ``stiffness`` per sphere of the first group or, against round cones only,
    ``stiffness_per_length`` of its rods.

    A group may be in contact with itself; pairs closer than ``skip`` in the group's order are then
    excluded. ``tip_spheres`` is the number of trailing spheres of the first group that contribute
    to F_t (14): by default one, or none for self-contact.

    ``friction`` is Coulomb's coefficient, ``stiffness_ratio`` the tangential stiffness as a
    multiple of the normal one, 2/3 unless given; see docs/friction.md.
    """

    description: ClassVar[str] = "contacts"

    first: Name
    second: Name
    shape: Annotated[Literal["spheres", "round-cones"], Choice("spheres", "round-cones")] = (
        "spheres"
    )
    stiffness: PositiveStiffness | None = None
    stiffness_per_length: PositiveStiffnessPerLength | None = None
    skip: Index = 0
    tip_spheres: Index | None = None
    friction: NonNegativeNumber = 0.0
    stiffness_ratio: PositiveNumber | None = None

    @model_validator(mode="after")
    def _check(self) -> Contact:
        check_ratio(self.friction, self.stiffness_ratio)
        if self.stiffness_per_length is None:
            if self.stiffness is None:
                raise field_error(f"is missing: {units.STIFFNESS.hint}", path="stiffness")
        elif self.stiffness is not None:
            raise field_error("has both stiffness and stiffness_per_length: give one")
        elif self.shape == "spheres":
            raise field_error('requires shape = "round-cones"', path="stiffness_per_length")
        return self

    def check(self, path: str, system: BodySystem) -> None:
        """Check that both groups exist and suit the shape."""
        check_known(self.first, "sphere group", system.spheres, f"{path}.first")
        check_known(self.second, "sphere group", system.spheres, f"{path}.second")
        if self.shape == "spheres":
            return
        for _, other, contact in system.entries(Contact):
            if contact.shape == "spheres" and self.second in (contact.first, contact.second):
                tail = f'is "{self.second}", whose spheres are used by {other}: define another'
                raise field_error(f"{tail} group for round cones", path=f"{path}.second")
        if self.stiffness_per_length is not None:
            group = system.spheres[self.first]
            for body in group.bodies:
                check_rod(body, system.bodies, f"spheres.{self.first}.bodies")
            if group.points:
                name = path.rpartition(".")[2]
                tail = f"has points, but {name} has a stiffness per length: use rods only"
                raise field_error(tail, path=f"spheres.{self.first}")

    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the contact to the engine."""
        first, second = system.spheres[self.first], system.spheres[self.second]
        count = len(first.lower(system.bodies))
        tip = 0 if self.first == self.second else 1
        tip = min(count, tip if self.tip_spheres is None else self.tip_spheres)
        stiffness = self.stiffness or self.stiffness_per_length
        assert stiffness is not None
        described = {
            "name": name,
            "first": self.first,
            "second": self.second,
            "stiffness": float(stiffness),
            "skip": self.skip,
            "tip_spheres": list(range(count - tip, count)),
        }
        if self.shape == "round-cones":
            described["cones"] = round_cones(second, system.bodies)
        if self.stiffness_per_length is not None:
            described["weights"] = length_shares(first, system.bodies)
            described["per_length"] = True
        return described


def round_cones(group: SphereGroup, bodies: Mapping[str, Body]) -> list[dict[str, object]]:
    """Describe the round cones that a solid group's spheres span.

    A link is one, from base to tip; a rod a chain of them, from sample point to sample point (its
    first sphere, at its joint, is left out: it is where the second one is); a single point is a
    sphere. Bodies that follow one another in the group and in the tree are joined: they share the
    sphere at the base of the second.
    """
    cones: list[dict[str, object]] = []
    start = 0
    before: str | None = None
    for name in group.bodies:
        body = bodies[name]
        ends = [0, 1] if not isinstance(body, Rod) else [*range(1, body.sample_count + 1)]
        for one, other in pairwise(ends):
            joined = one != ends[0] or (before is not None and _continues(body, before))
            cones.append({"ends": [start + one, start + other], "joined": joined})
        start += ends[-1] + 1
        before = name
    singles = range(start, start + len(group.points))
    return cones + [{"ends": [index, index], "joined": False} for index in singles]


def _continues(body: Body, before: str) -> bool:
    place = body.placement
    moved = any((place.x, place.y, place.z)) or place.reference == "underside"
    return body.parent == before and not moved and body.joint.kind not in ("prismatic", "free")


def length_shares(group: SphereGroup, bodies: Mapping[str, Body]) -> list[float]:
    """Share the length of a group's rods out among their spheres, by the trapezoidal rule.

    The sphere at a rod's joint gets nothing: the one at its first sample point is there as well.
    """
    shares: list[float] = []
    for name in group.bodies:
        rod = bodies[name]
        assert isinstance(rod, Rod)
        intervals = np.diff(rod.sample_points)
        halves = 0.5 * intervals
        inner = np.concatenate([halves, [0.0]]) + np.concatenate([[0.0], halves])
        shares += [0.0, *inner.tolist()]
    return shares
