"""What acts on and between bodies, as the engine's description has it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor.model.round_cones import length_shares, round_cones
from flexor.model.schema import (
    Actuator,
    Attachment,
    Body,
    Contact,
    Ground,
    Rod,
    SphereGroup,
    Spring,
    Station,
    Wrench,
)

Array = NDArray[np.float64]
Json = dict[str, Any]


def sphere_group(group: SphereGroup, bodies: dict[str, Body], solid: bool = False) -> list[Json]:
    """Describe a group of spheres; see `schema.SphereGroup` for where they are.

    In a ``solid`` group, which round cones are made of, links have them at both ends.
    """
    spheres: list[Json] = []
    for name in group.bodies:
        body = bodies[name]
        if isinstance(body, Rod):
            stations: list[Any] = [{"point": 0}]
            stations += [{"point": index} for index in range(body.sample_count)]
        else:
            stations = [{"fraction": 0.0}, {"fraction": 1.0} if solid else "centroid"]
        spheres += [{"body": name, "station": station} for station in stations]
    return spheres + [_place(station, bodies) for station in group.points]


def lower_contact(
    name: str, contact: Contact, groups: dict[str, SphereGroup], bodies: dict[str, Body]
) -> Json:
    """Describe a contact."""
    first, second = groups[contact.first], groups[contact.second]
    count = len(sphere_group(first, bodies))
    tip = 0 if contact.first == contact.second else 1
    tip = min(count, tip if contact.tip_spheres is None else contact.tip_spheres)
    stiffness = contact.stiffness or contact.stiffness_per_length
    assert stiffness is not None
    described = {
        "name": name,
        "first": contact.first,
        "second": contact.second,
        "stiffness": float(stiffness),
        "skip": contact.skip,
        "tip_spheres": list(range(count - tip, count)),
    }
    if contact.shape == "round-cones":
        described["cones"] = round_cones(second, bodies)
    if contact.stiffness_per_length is not None:
        described["weights"] = length_shares(first, bodies)
        described["per_length"] = True
    return described


def lower_actuator(name: str, actuator: Actuator, points: Array) -> Json:
    """Describe an actuator, at the sample points (P,) of its rod."""
    path, slope = actuator.path.sampled(points)
    return {
        "name": name,
        "kind": actuator.kind,
        "rod": actuator.rod,
        "path": path.tolist(),
        "path_slope": slope.tolist(),
        "lever": [actuator.lever.y, actuator.lever.z],
    }


def lower_spring(name: str, spring: Spring, bodies: dict[str, Body]) -> Json:
    """Describe a spring."""
    if isinstance(spring.second, Ground):
        second: Json = {"world": list(spring.second.world.components)}
    else:
        second = _attachment(spring.second, bodies)
    return {
        "name": name,
        "first": _attachment(spring.first, bodies),
        "second": second,
        "stiffness": float(spring.stiffness),
        "rest_length": float(spring.rest_length),
        "slack": spring.slack,
    }


def lower_wrench(name: str, wrench: Wrench, bodies: dict[str, Body]) -> Json:
    """Describe a wrench."""
    return {
        "name": name,
        "at": _attachment(wrench, bodies),
        "force": list(wrench.force.components),
        "moment": list(wrench.moment.components),
        "frame": wrench.frame,
        "input": wrench.input,
    }


def _attachment(attachment: Attachment, bodies: dict[str, Body]) -> Json:
    return {**_place(attachment, bodies), "offset": list(attachment.offset.components)}


def _place(station: Station, bodies: dict[str, Body]) -> Json:
    return {"body": station.body, "station": _station(station, bodies[station.body])}


def _station(station: Station, body: Body) -> Any:
    if station.at == "centroid":
        return "centroid"
    if station.point is not None:
        return {"point": station.point}
    assert station.at is not None
    fraction = {"base": 0.0, "tip": 1.0}.get(str(station.at), station.at)
    if isinstance(body, Rod):
        return {"point": body.point_at(float(fraction))}
    return {"fraction": float(fraction)}
