"""Contact of bodies with obstacles through their skins."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from flexor.arrays import Array
from flexor.model.schema.body import Link
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.foundation import CROWN, is_joined, skin_materials, underside
from flexor.model.schema.skin import Skin, compliance

# Points at which contact is integrated along a link, at the middles of equal parts: as many as
# needed that obstacles cannot pass between them.
MIN_POINTS, MAX_POINTS = 20, 200
# Of a sphere, what a round end adds to a body that lies on an obstacle.
END = 0.5


def group_name(body: str) -> str:
    """Return the name of the group of the points at which a body touches obstacles."""
    return f"{body}.outside"


def lower_outsides(system: BodySystem) -> Iterator[dict[str, Any]]:
    """Describe the points at which bodies touch obstacles to the engine, a group for each."""
    for name in system.pressing:
        spheres = [{"body": name, "station": station} for station in _stations(name, system)]
        yield {"name": group_name(name), "spheres": spheres}


def lower_touch(
    name: str, system: BodySystem, skin: Skin | None, axis: Array | None, curved: bool
) -> dict[str, Any]:
    """Describe how a body's skin presses on an obstacle to the engine.

    Parameters
    ----------
    name
        The body.
    system
        All bodies.
    skin
        The obstacle's own skin; it is rigid without.
    axis
        Unit vector (3,) along a round obstacle in the world; none for a sphere and for one that is
        flat.
    curved
        Whether the obstacle is curved.
    """
    body = system.bodies[name]
    materials = skin_materials(system)
    if isinstance(body, Link):
        inner = _points(name, body, system)
        count = inner + 2
        weights, caps = np.full(count, 1.0 / inner), np.zeros(count)
        weights[[0, -1]] = 0.0
        caps[[0, -1]] = END * np.array(_free_ends(name, system))
        shape = {
            "half_width": [0.0] * count,
            "half_width_multiple": [1.0] * count,
            "roundness": 1.0,
        }
    else:
        weights, caps = np.zeros((2, body.sample_count))
        points, shares = body.gauss_rule
        weights[points] = shares
        shape = underside(body, system)
    alignment = 0.0
    if curved:
        alignment = 1.0 if axis is None else float(axis @ _direction(name, system)) ** 2
    return {
        "spheres": group_name(name),
        "weights": weights.tolist(),
        "caps": caps.tolist(),
        **shape,
        "crown": CROWN,
        "stiffness": 1.0 / (compliance(body.skin, materials) + compliance(skin, materials)),
        "alignment": alignment,
    }


def _stations(name: str, system: BodySystem) -> list[dict[str, Any]]:
    body = system.bodies[name]
    if isinstance(body, Link):
        count = _points(name, body, system)
        middles = ((np.arange(count) + 0.5) / count).tolist()
        return [{"fraction": f} for f in (0.0, *middles, 1.0)]
    return [{"point": k} for k in range(body.sample_count)]


def _points(name: str, link: Link, system: BodySystem) -> int:
    """Return at how many points contact is integrated along a link."""
    reach = system.pressing[name] + min(link.radius.base, link.radius.tip)
    return max(MIN_POINTS, math.ceil(min(link.length / reach, MAX_POINTS)))


def _free_ends(name: str, system: BodySystem) -> tuple[bool, bool]:
    """Whether base and tip of a link are joined to no other link."""
    links = {key: body for key, body in system.bodies.items() if isinstance(body, Link)}
    own = links[name]
    based = own.parent in links and is_joined(own, str(own.parent))
    return not based, not any(is_joined(link, name) for link in links.values())


def _direction(name: str, system: BodySystem) -> Array:
    """Return the unit vector (3,) from end to end of a body in the reference state."""
    frame = system.reference_frames[name]
    chord = frame(1.0)[:3, 3] - frame(0.0)[:3, 3]
    return np.asarray(chord / max(float(np.linalg.norm(chord)), 1e-300))
