"""Rules of a model file that tie one table to another."""

from __future__ import annotations

import re
from collections.abc import Iterable

from flexor.errors import unknown_name
from flexor.model.fault import fault
from flexor.model.schema.body import Link, Rod
from flexor.model.schema.points import Attachment, Contact, Station
from flexor.model.schema.tables import Tables

_NAME = re.compile(r"[A-Za-z]\w*(-\w+)*", re.ASCII)
_TABLES = ("bodies", "spheres", "contacts", "obstacles", "actuators", "springs", "wrenches")
# What the engine finds by name alone; sphere groups may be called like the body they cover.
_SHARED = ("bodies", "contacts", "obstacles", "actuators", "springs", "wrenches")


def check_names(file: Tables) -> None:
    """Demand plain names, and different ones where one thing could be taken for another."""
    for table in _TABLES:
        for name in getattr(file, table):
            if not _NAME.fullmatch(name):
                allowed = "a name starts with a letter and has letters, digits, _ and -"
                raise fault(f'has the name "{name}": {allowed}', path=table)
    owner: dict[str, str] = {}
    for table in _SHARED:
        for name in getattr(file, table):
            if name in owner:
                raise fault(f"has the name of {owner[name]}.{name}", path=f"{table}.{name}")
            owner[name] = table


def check_tree(file: Tables) -> None:
    """Demand that every parent exists and that no body descends from itself."""
    for name, body in file.bodies.items():
        if body.parent is not None:
            _demand(body.parent, "body", file.bodies, f"bodies.{name}.parent")
    for name in file.bodies:
        line = [name]
        while (parent := file.bodies[line[-1]].parent) is not None:
            if parent == name:
                loop = " -> ".join([*line, name])
                raise fault(
                    f'is "{file.bodies[name].parent}": a body cannot descend from itself ({loop})',
                    path=f"bodies.{name}.parent",
                )
            if parent in line:
                break  # a loop further up, reported at its own bodies
            line.append(parent)


def check_references(file: Tables) -> None:
    """Demand that every name used is the name of something."""
    for name, group in file.spheres.items():
        for body in group.bodies:
            _demand(body, "body", file.bodies, f"spheres.{name}.bodies", "names")
        for index, station in enumerate(group.points):
            _check_station(file, station, f"spheres.{name}.points[{index}]")
    for name, contact in file.contacts.items():
        _demand(contact.first, "sphere group", file.spheres, f"contacts.{name}.first")
        _demand(contact.second, "sphere group", file.spheres, f"contacts.{name}.second")
        _check_shape(file, name, contact)
    for name, obstacle in file.obstacles.items():
        for stopped in obstacle.spheres:
            _demand(stopped, "sphere group", file.spheres, f"obstacles.{name}.spheres", "names")
    for name, actuator in file.actuators.items():
        _demand_rod(file, actuator.rod, f"actuators.{name}.rod")
    for name, spring in file.springs.items():
        _check_station(file, spring.first, f"springs.{name}.first")
        if isinstance(spring.second, Attachment):
            _check_station(file, spring.second, f"springs.{name}.second")
    for name, wrench in file.wrenches.items():
        _check_station(file, wrench, f"wrenches.{name}")
    if file.design is not None:
        _demand_rod(file, file.design.rod, "design.rod")


def _check_shape(file: Tables, name: str, contact: Contact) -> None:
    if contact.shape == "spheres":
        return
    for other, spheres in file.contacts.items():
        if spheres.shape == "spheres" and contact.second in (spheres.first, spheres.second):
            tail = (
                f'is "{contact.second}", whose spheres {other} needs where they are: make another'
            )
            raise fault(f"{tail} group for round cones", path=f"contacts.{name}.second")
    if contact.stiffness_per_length is not None:
        group = file.spheres[contact.first]
        for body in group.bodies:
            _demand_rod(file, body, f"spheres.{contact.first}.bodies")
        if group.points:
            tail = f"has single points, but {name} has a stiffness per length: give it rods only"
            raise fault(tail, path=f"spheres.{contact.first}")


def _demand(name: str, kind: str, allowed: Iterable[str], path: str, verb: str = "is") -> None:
    names = list(allowed)
    if name not in names:
        raise fault(f"{verb} the {unknown_name(kind, name, names)}", path=path)


def _demand_rod(file: Tables, name: str, path: str) -> None:
    _demand(name, "body", file.bodies, path)
    if not isinstance(file.bodies[name], Rod):
        rods = ", ".join(f'"{n}"' for n, body in file.bodies.items() if isinstance(body, Rod))
        raise fault(f'is "{name}", which is a link: rods are {rods or "none"}', path=path)


def _check_station(file: Tables, station: Station, path: str) -> None:
    _demand(station.body, "body", file.bodies, f"{path}.body")
    body, name = file.bodies[station.body], station.body
    if isinstance(body, Link):
        if station.point is not None:
            tail = f'is {station.point}: only rods have points, and "{name}" is a link'
            raise fault(tail, path=f"{path}.point")
    elif station.at == "centroid":
        tail = f'is "centroid": only links have one, and "{name}" is a rod'
        raise fault(tail, path=f"{path}.at")
    elif station.point is not None:
        if station.point >= body.sample_count:
            tail = f'is {station.point}: the points of "{name}" are 0 to {body.sample_count - 1}'
            raise fault(tail, path=f"{path}.point")
    elif isinstance(station.at, float) and body.point_at(station.at) is None:
        tail = f'is {station.at!r}: on the rod "{name}" it must be a multiple of 1/{body.elements}'
        raise fault(f"{tail} (an element's end)", path=f"{path}.at")
