"""Conversion of equilibria to scenes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.plot.outline import refine
from flexor.plot.scene import ContactArrow, Line, Link, Rod, Scene

if TYPE_CHECKING:
    from flexor.model import ContactForces, Path
    from flexor.model.schema.actuator import Actuator


def read_scene(path: Path, step: int = -1) -> Scene:
    """Return the bodies, lines and contact forces of a model at one load step."""
    model, frames = path.model, path.frames(step)
    rods: dict[str, Rod] = {}
    stations: dict[str, Array] = {}
    links: list[Link] = []
    for name, body in model.file.bodies.items():
        if body.kind == "rod":
            fine, station = refine(frames[name])
            height = _at(station, model.slot(f"{name}.radius", path.parameters))
            # A circular section has no ratio.
            rods[name] = Rod(name, fine, height, (body.section.ratio or 1.0) * height)
            stations[name] = station
        else:
            base, tip = frames[name][0, :3, 3], frames[name][-1, :3, 3]
            r_base, r_tip = (
                float(model.slot(f"{name}.radius_{end}", path.parameters)[0])
                for end in ("base", "tip")
            )
            moves = body.joint.kind != "fixed"
            links.append(Link(name, base, tip, r_base, r_tip, moves))
    lines = [
        _line(path, name, actuator, rods[actuator.rod], stations[actuator.rod])
        for name, actuator in model.file.actuators.items()
    ]
    return Scene(list(rods.values()), links, lines, _contact_arrows(path.contact_forces(step)))


def _line(path: Path, name: str, actuator: Actuator, rod: Rod, station: Array) -> Line:
    sampled, _ = actuator.path.sampled(path.model.file.rod(actuator.rod).sample_points)
    lever = path.model.slot(f"{name}.lever", path.parameters)
    offset = np.stack([_at(station, column) for column in sampled.T], axis=1)
    offset = offset + rod.half_height[:, None] * lever
    # A lever beyond the surface is only a lever arm: draw the line on the surface and state the
    # lever in the legend.
    outside = np.hypot(offset[:, 0] / rod.half_width, offset[:, 1] / rod.half_height)
    beyond = float(np.max(outside))
    offset = offset / np.maximum(outside, 1.0)[:, None]
    points = rod.frames[:, :3, 3] + np.einsum("mij,mj->mi", rod.frames[:, :3, 1:3], offset)
    label: str = actuator.kind
    if beyond > 1.0 + 1e-9:
        label += f" (acts at {beyond:.3g} S)"
    return Line(name, points, label)


def _at(station: Array, samples: Array) -> Array:
    return np.interp(station, np.arange(len(samples)), samples)


def _contact_arrows(contacts: ContactForces) -> list[ContactArrow]:
    contact_arrows = []
    # Sum the forces on each sphere of the limb; on round cones show each contact point.
    places = np.where(contacts.cone, -1 - contacts.first.astype(np.int64), contacts.second)
    for place in np.unique(places):
        selected = places == place
        force = -contacts.force[selected]
        magnitude = np.linalg.norm(force, axis=1)
        point = np.average(contacts.point[selected], axis=0, weights=np.maximum(magnitude, 1e-300))
        contact_arrows.append(ContactArrow(point, force.sum(axis=0)))
    return contact_arrows
