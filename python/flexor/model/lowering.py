"""From a model file to the engine's description: SI numbers, every list explicit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexor._engine import sample_points
from flexor.model.interactions import (
    Json,
    lower_actuator,
    lower_contact,
    lower_spring,
    lower_wrench,
    sphere_group,
)
from flexor.model.schema import (
    Body,
    FixedJoint,
    FreeJoint,
    Joint,
    Link,
    ModelFile,
    Obstacle,
    PrismaticJoint,
    RevoluteJoint,
    Rod,
)
from flexor.model.schema.profile import surface
from flexor.model.schema.strain import MODES

Array = NDArray[np.float64]


def lower(file: ModelFile) -> Json:
    """Describe a model to the engine.

    Parameters
    ----------
    file
        A checked model file.

    Returns
    -------
    dict
        The description, ready for JSON: SI units, parents before their children, the radius of
        each rod at its sample points.
    """
    bodies = {name: file.bodies[name] for name in parents_first(file.bodies)}
    solid = {contact.second for contact in file.contacts.values() if contact.shape != "spheres"}
    spheres = {
        name: sphere_group(group, bodies, name in solid) for name, group in file.spheres.items()
    }
    return {
        "planar": file.planar,
        "gravity": list(file.gravity.components),
        "bodies": [_body(name, body, file.planar) for name, body in bodies.items()],
        "spheres": [{"name": name, "spheres": group} for name, group in spheres.items()],
        "contacts": [
            lower_contact(name, contact, file.spheres, bodies)
            for name, contact in file.contacts.items()
        ],
        "actuators": [
            lower_actuator(name, actuator, points(file.rod(actuator.rod)))
            for name, actuator in file.actuators.items()
        ],
        "half_spaces": [_half_space(name, wall) for name, wall in file.obstacles.items()],
        "springs": [lower_spring(name, spring, bodies) for name, spring in file.springs.items()],
        "wrenches": [lower_wrench(name, wrench, bodies) for name, wrench in file.wrenches.items()],
    }


def parents_first(bodies: dict[str, Body]) -> list[str]:
    """Return the names of bodies in the file's order, except that parents come first.

    Parameters
    ----------
    bodies
        Bodies whose parents exist and form no loop.
    """
    order: dict[str, None] = {}
    for name in bodies:
        line: list[str] = []
        above: str | None = name
        while above is not None and above not in order:
            line.append(above)
            above = bodies[above].parent
        order.update(dict.fromkeys(reversed(line)))
    return list(order)


def points(rod: Rod) -> Array:
    """Return the sample points of a rod: X in [0, 1], element ends and Gauss points.

    Parameters
    ----------
    rod
        The rod.
    """
    return sample_points(rod.elements, rod.gauss_points)


def dorsal(body: Body) -> Array:
    """Return the local z axis of a body's placement, in its parent's frame; shape (3,).

    Parameters
    ----------
    body
        The body.
    """
    vector = np.array(body.placement.rotation.components)
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.array([0.0, 0.0, 1.0])
    axis, up = vector / angle, np.array([0.0, 0.0, 1.0])
    along = axis * axis[2]  # Rodrigues' formula
    return np.asarray(along + np.cos(angle) * (up - along) + np.sin(angle) * np.cross(axis, up))


def _body(name: str, body: Body, planar: bool) -> Json:
    place = body.placement
    translation = np.array([place.x, place.y, place.z], dtype=float)
    if isinstance(body, Rod):
        radius, slope = surface(body.radius, points(body))
        if place.reference == "underside":
            translation = translation + radius[0] * dorsal(body)
        shape = {"rod": _rod(body, radius, slope)}
    else:
        shape = {"link": _link(body)}
    return {
        "name": name,
        "parent": body.parent,
        "placement": {
            "translation": translation.tolist(),
            "rotation": list(place.rotation.components),
        },
        "joint": _joint(body.joint, planar),
        "shape": shape,
    }


def _rod(rod: Rod, radius: Array, slope: Array) -> Json:
    section: Json = {"kind": rod.section.kind}
    if rod.section.ratio is not None:
        section["ratio"] = rod.section.ratio
    return {
        "length": float(rod.length),
        "section": section,
        "strain": [
            {"mode": mode, "basis": chosen.basis, "order": chosen.order or 0}
            for mode, chosen in rod.strain.modes.items()
        ],
        "elements": rod.elements,
        "gauss_points": rod.gauss_points,
        "magnus_order": rod.magnus_order,
        "young_modulus": float(rod.young_modulus),
        "shear_modulus": rod.shear_modulus,
        "density": float(rod.density),
        "reference_strain": [float(getattr(rod.reference_strain, mode)) for mode in MODES],
        "radius": radius.tolist(),
        "slope": slope.tolist(),
    }


def _link(link: Link) -> Json:
    return {
        "length": float(link.length),
        "radius_base": float(link.radius.base),
        "radius_tip": float(link.radius.tip),
        "density": float(link.density),
    }


def _direction(axis: tuple[float, float, float]) -> list[float]:
    scaled = np.array(axis) / np.max(np.abs(axis))  # or the norm of a huge axis would overflow
    direction: list[float] = (scaled / np.linalg.norm(scaled)).tolist()
    return direction


def _half_space(name: str, obstacle: Obstacle) -> Json:
    return {
        "name": name,
        "spheres": list(obstacle.spheres),
        "point": list(obstacle.point.components),
        "normal": _direction(obstacle.normal),
        "stiffness": float(obstacle.stiffness),
    }


def _joint(joint: Joint, planar: bool) -> Json:
    if isinstance(joint, FixedJoint):
        return {"kind": "fixed"}
    if isinstance(joint, (RevoluteJoint, PrismaticJoint)):
        return {
            "kind": joint.kind,
            "axis": _direction(joint.axis),
            "stiffness": [float(joint.stiffness)],
            "rest": [float(joint.rest)],
            "lower": [None if joint.lower is None else float(joint.lower)],
            "upper": [None if joint.upper is None else float(joint.upper)],
            "limit_stiffness": float(joint.limit_stiffness),
            "limit_width": float(joint.limit_width),
        }
    stiffness = [float(value) for value in joint.stiffness]
    if isinstance(joint, FreeJoint):
        stiffness += [float(value) for value in joint.linear_stiffness]
        if planar:
            stiffness = [stiffness[1], stiffness[3], stiffness[5]]
    return {"kind": joint.kind, "stiffness": stiffness, "rest": [0.0] * len(stiffness)}
