"""Conversion of equilibria to scenes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from flexor.arrays import Array
from flexor.model.schema import Rod as RodTable
from flexor.plot.outline import refine
from flexor.plot.scene import ContactArrow, Line, Link, Mark, Pressure, Rod, Scene
from flexor.plot.style import STRAP
from flexor.plot.surroundings import bones, obstacles, springs, tendons, ties

if TYPE_CHECKING:
    from flexor.model import ContactForces, Path
    from flexor.model.schema import ModelFile
    from flexor.model.schema.actuator import Actuator

# Of each quantity: symbol, side of the body that it is marked on, unit and label.
MARKS = {
    "max_contact_pressure": ("v", -1.0, 1e3, "largest contact pressure, {:.3g} kPa"),
    "max_strain": ("s", 0.0, 1e-2, "largest strain, {:.3g} %"),
}
# Label and colour of points with friction.
STICKS = ("friction holds", "#009E73")
SLIDES = ("friction is overcome: slides", "#D55E00")


def read_scene(path: Path, step: int = -1, file: ModelFile | None = None) -> Scene:
    """Return the bodies, lines and contact forces of a model at one load step.

    Sections are those of the file, or else of the model.
    """
    from flexor.model.schema.section_geometry import half_width
    from flexor.plot.lengthwise import bands

    model, frames = path.model, path.frames(step)
    materials = (file or model.file).materials
    rods: dict[str, Rod] = {}
    stations: dict[str, Array] = {}
    links: list[Link] = []
    for name, body in model.file.bodies.items():
        if body.kind == "rod":
            fine, station = refine(frames[name])
            height = _at(station, model.slot(f"{name}.radius", path.parameters))
            shown = body if file is None else file.rod(name)
            x = _at(station, body.sample_points)
            width = half_width(shown, materials, height, x)
            rods[name] = Rod(name, fine, height, width, bands(shown, materials, x, height))
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
        if actuator.kind != "pressure"
    ]
    lines += [_strap(path, name, frames) for name in model.file.straps]
    lines += bones(path, frames)
    lines += springs(path, frames)
    lines += tendons(path, frames, step)
    lines += ties(path, frames)
    contacts = path.contact_forces(step)
    arrows = _contact_arrows(path, contacts)
    pressures = _pressures(path, contacts, frames)
    gravity = np.array(model.file.gravity.components, dtype=float)
    scene = Scene(list(rods.values()), links, lines, arrows, pressures=pressures, gravity=gravity)
    return replace(scene, lines=[*lines, *obstacles(path, frames, *scene.extent())])


def bending(path: Path) -> float | None:
    """Return the sum of the joint angles at the last load [rad]; None if no joint turns."""
    turning = [path.model.joints.index(name) for name in path.model.angular_joints]
    return float(path.joint_angles[-1, turning].sum()) if turning else None


def marked(scene: Scene, path: Path, step: int = -1) -> Scene:
    """Return a scene with marks where contact pressure and strain are largest and friction acts."""
    frames, marks = path.frames(step), []
    for key, each in path[step].extremes().items():
        if key in MARKS:
            symbol, side, unit, label = MARKS[key]
            point = _on_surface(path, frames, each.body, each.X, side)
            marks.append(Mark(symbol, point, label.format(each.value / unit)))
    rubbing = path.friction_forces(step)
    for point, slides in zip(rubbing.place, rubbing.slides, strict=True):
        marks.append(Mark("o", point, *(SLIDES if slides else STICKS)))
    return replace(scene, marks=marks)


def _strap(path: Path, name: str, frames: dict[str, Array]) -> Line:
    """Draw a strap around both bodies: from the rod's top to the other's bottom."""
    strap = path.model.file.straps[name]
    if strap.listed() == "loops":
        base, tip = frames[strap.to.body][[0, -1], :3, 3]
        held = _on_surface(path, frames, strap.rod, strap.at, 0.0) - base
        place = float(np.clip(held @ (tip - base) / ((tip - base) @ (tip - base)), 0.0, 1.0))
    else:
        place = strap.fraction(path.model.file)
    ends = ((strap.rod, strap.at), (strap.to.body, place))
    points = [_on_surface(path, frames, *end, side) for end in ends for side in (1.0, -1.0)]
    return Line(name, np.array(points), "strap", STRAP)


def _on_surface(path: Path, frames: dict[str, Array], name: str, x: float, side: float) -> Array:
    """Return a point above (1), on (0) or below (-1) the axis of a body, at a fraction x of it."""
    body, along = path.model.file.bodies[name], frames[name]
    if isinstance(body, RodTable):
        index = int(np.argmin(np.abs(body.sample_points - x)))
        centre, up = along[index, :3, 3], along[index, :3, 2]
        radius = float(path.model.slot(f"{name}.radius", path.parameters)[index])
    else:
        centre, up = (1.0 - x) * along[0, :3, 3] + x * along[-1, :3, 3], along[0, :3, 2]
        slots = (
            path.model.slot(f"{name}.radius_{end}", path.parameters) for end in ("base", "tip")
        )
        base, tip = (float(slot[0]) for slot in slots)
        radius = base + x * (tip - base)
    return np.asarray(centre + side * radius * up)


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


def _pressures(path: Path, contacts: ContactForces, frames: dict[str, Array]) -> list[Pressure]:
    """Return the largest pressure across at each sample point of each rod that has a skin."""
    touching = np.flatnonzero(np.isfinite(contacts.pressure))
    if not touching.size:
        return []
    model, values = path.model, dict[str, Array]()
    starts = {name: start for name, (start, _) in model.engine.sphere_groups.items()}
    for index in touching.tolist():
        first = int(contacts.first[index])
        rod = model.sphere_places[first][0]
        if not isinstance(model.file.bodies.get(rod), RodTable):
            continue
        found = values.setdefault(rod, np.zeros(len(frames[rod])))
        place = first - starts[f"{rod}.skin"]
        found[place] = max(found[place], float(contacts.pressure[index]))
    made = []
    for rod, found in values.items():
        half = model.slot(f"{rod}.radius", path.parameters)[:, None]
        down = -frames[rod][:, :3, 2]
        made.append(Pressure(frames[rod][:, :3, 3] + half * down, down, found))
    return made


def _contact_arrows(path: Path, contacts: ContactForces) -> list[ContactArrow]:
    contact_arrows = []
    # Sum the forces on each sphere of the limb, and those through the skin of each link; on other
    # round cones and obstacles show each contact point.
    apart = contacts.cone | (contacts.second < 0)
    places = np.where(apart, -1 - contacts.first.astype(np.int64), contacts.second)
    spheres = path.model.sphere_places if np.isfinite(contacts.pressure).any() else ()
    names = list(dict.fromkeys(name for name, _ in spheres))
    for index in np.flatnonzero(np.isfinite(contacts.pressure)).tolist():
        places[index] = len(spheres) + names.index(spheres[int(contacts.second[index])][0])
    for place in np.unique(places):
        selected = places == place
        force = -contacts.force[selected]
        magnitude = np.linalg.norm(force, axis=1)
        point = np.average(contacts.point[selected], axis=0, weights=np.maximum(magnitude, 1e-300))
        contact_arrows.append(ContactArrow(point, force.sum(axis=0)))
    return contact_arrows
