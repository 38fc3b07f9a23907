"""From a model file to the engine's description: SI numbers, every list explicit."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexor.model.schema import (
    Body,
    FixedJoint,
    FreeJoint,
    Joint,
    Link,
    ModelFile,
    PrismaticJoint,
    RevoluteJoint,
    Rod,
)
from flexor.model.schema.foundation import lower_self_contact, lower_skins
from flexor.model.schema.friction import frictions
from flexor.model.schema.section import Solid
from flexor.model.schema.section_geometry import is_made_of_fibres, lower_fibres
from flexor.model.schema.strain import MODES
from flexor.model.schema.strap import Loop
from flexor.model.schema.touched import lower_outsides
from flexor.model.schema.vector import direction

Json = dict[str, Any]


def lower(file: ModelFile) -> Json:
    """Describe a model to the engine."""
    described: Json = {
        "planar": file.planar,
        "gravity": list(file.gravity.components),
        "bodies": [
            _body(name, file.bodies[name], file.planar) for name in parents_first(file.bodies)
        ],
    }
    solid = {contact.second for contact in file.contacts.values() if contact.shape != "spheres"}
    for name, group in file.spheres.items():
        spheres = group.lower(file.bodies, name in solid)
        described.setdefault("spheres", []).append({"name": name, "spheres": spheres})
    for groups, foundation in lower_skins(file):
        described.setdefault("spheres", []).extend(groups)
        described.setdefault("foundations", []).append(foundation)
    for name, strap in file.straps.items():
        if isinstance(strap.to, Loop):
            described.setdefault("spheres", []).append(strap.group(name, file))
    for own, contact in lower_self_contact(file):
        described.setdefault("spheres", []).append(own)
        described.setdefault("contacts", []).append(contact)
    if file.pressing:
        described.setdefault("spheres", []).extend(lower_outsides(file))
    materials = [material.lower(name) for name, material in file.materials.items()]
    if materials:
        described["materials"] = materials
    for name, body in file.bodies.items():
        if isinstance(body, Rod) and is_made_of_fibres(body):
            fibres = lower_fibres(name, body, file.materials, file.planar)
            described.setdefault("fibres", []).append(fibres)
    for _, name, force in file.forces():
        described.setdefault(force.listed(), []).append(force.lower(name, file))
    rubbing = [each.described for each in frictions(file)]
    if rubbing:
        described["frictions"] = rubbing
    if file.inputs:
        described["shared_inputs"] = [
            {"name": name, "drives": list(drives)} for name, drives in file.inputs.items()
        ]
    controls = [name for name, each in file.actuators.items() if each.loads is not each.applied]
    if controls:
        described["controls"] = controls
    return described


def parents_first(bodies: dict[str, Body]) -> list[str]:
    """Return the names of bodies in the file's order, except that parents come first."""
    order: dict[str, None] = {}
    for name in bodies:
        line: list[str] = []
        above: str | None = name
        while above is not None and above not in order:
            line.append(above)
            above = bodies[above].parent
        order.update(dict.fromkeys(reversed(line)))
    return list(order)


def _body(name: str, body: Body, planar: bool) -> Json:
    place = body.placement
    translation = np.array([place.x, place.y, place.z], dtype=float)
    if isinstance(body, Rod):
        if place.reference == "underside":
            translation = translation + body.surface.radius[0] * place.dorsal
        shape = {"rod": _rod(body)}
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


def _rod(rod: Rod) -> Json:
    if is_made_of_fibres(rod):
        section: Json = {"kind": "fibres"}
        # Not used by the engine, which takes those of the fibres.
        young, shear = 1.0, 1.0
    else:
        assert isinstance(rod.section, Solid) and rod.young_modulus is not None
        section = {"kind": rod.section.kind}
        if rod.section.ratio is not None:
            section["ratio"] = rod.section.ratio
        young, shear = float(rod.young_modulus), rod.shear_modulus
    # Left out where the last element is undivided: those models keep their fingerprint.
    divided = {"tip_intervals": rod.last_intervals} if rod.last_intervals > 1 else {}
    return {
        "length": float(rod.length),
        "section": section,
        **divided,
        "strain": [
            {"mode": mode, "basis": chosen.basis, "order": chosen.order or 0}
            for mode, chosen in rod.strain.modes.items()
        ],
        "elements": rod.elements,
        "gauss_points": rod.gauss_points,
        "magnus_order": rod.magnus_order,
        "young_modulus": young,
        "shear_modulus": shear,
        "density": float(rod.density),
        "reference_strain": [float(getattr(rod.reference_strain, mode)) for mode in MODES],
        "radius": rod.surface.radius.tolist(),
        "slope": rod.surface.slope.tolist(),
    }


def _link(link: Link) -> Json:
    return {
        "length": float(link.length),
        "radius_base": float(link.radius.base),
        "radius_tip": float(link.radius.tip),
        "density": float(link.density),
    }


def _joint(joint: Joint, planar: bool) -> Json:
    if isinstance(joint, FixedJoint):
        return {"kind": "fixed"}
    if isinstance(joint, (RevoluteJoint, PrismaticJoint)):
        return {
            "kind": joint.kind,
            "axis": direction(joint.axis),
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
