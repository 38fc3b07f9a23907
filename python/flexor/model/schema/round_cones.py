"""Round cones of a group of spheres, and how contact per length is shared out among spheres."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from flexor.model.schema.body import Body, Rod
from flexor.model.schema.points import SphereGroup

Json = dict[str, object]


def round_cones(group: SphereGroup, bodies: Mapping[str, Body]) -> list[Json]:
    """Describe the round cones that a solid group's spheres span.

    A link is one, from base to tip; a rod a chain of them, from sample point to sample point (its
    first sphere, at its joint, is left out: it is where the second one is); a single point is a
    sphere. Bodies that follow one another in the group and in the tree are joined: they share the
    sphere at the base of the second.
    """
    cones: list[Json] = []
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
