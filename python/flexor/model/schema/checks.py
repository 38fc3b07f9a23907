"""Consistency checks between the tables of a model file."""

from __future__ import annotations

import re
from collections.abc import Iterable

from flexor.errors import unknown_name
from flexor.model.schema.body import Link, Rod
from flexor.model.schema.points import Attachment, Contact, Station
from flexor.model.schema.tables import Tables
from flexor.model.validation import field_error

_NAME = re.compile(r"[A-Za-z]\w*(-\w+)*", re.ASCII)
_TABLES = ("bodies", "spheres", "contacts", "obstacles", "actuators", "springs", "wrenches")
# What the engine finds by name alone; sphere groups may be called like the body they cover.
_SHARED = ("bodies", "contacts", "obstacles", "actuators", "springs", "wrenches")


def check_names(file: Tables) -> None:
    """Check that names are valid, and unique across the tables that share a namespace."""
    for table in _TABLES:
        for name in getattr(file, table):
            if not _NAME.fullmatch(name):
                rule = "names start with a letter and consist of letters, digits, _ and -"
                raise field_error(f'contains "{name}": {rule}', path=table)
    owner: dict[str, str] = {}
    for table in _SHARED:
        for name in getattr(file, table):
            if name in owner:
                raise field_error(
                    f"has the same name as {owner[name]}.{name}", path=f"{table}.{name}"
                )
            owner[name] = table


def check_tree(file: Tables) -> None:
    """Check that every parent exists and that there are no cycles."""
    for name, body in file.bodies.items():
        if body.parent is not None:
            _check_known(body.parent, "body", file.bodies, f"bodies.{name}.parent")
    for name in file.bodies:
        chain = [name]
        while (parent := file.bodies[chain[-1]].parent) is not None:
            if parent == name:
                cycle = " -> ".join([*chain, name])
                raise field_error(
                    f'is "{file.bodies[name].parent}": a body cannot be its own ancestor ({cycle})',
                    path=f"bodies.{name}.parent",
                )
            if parent in chain:
                break  # a cycle of the ancestors, reported there
            chain.append(parent)


def check_references(file: Tables) -> None:
    """Check that every reference resolves."""
    for name, group in file.spheres.items():
        for body in group.bodies:
            _check_known(body, "body", file.bodies, f"spheres.{name}.bodies")
        for index, station in enumerate(group.points):
            _check_station(file, station, f"spheres.{name}.points[{index}]")
    for name, contact in file.contacts.items():
        _check_known(contact.first, "sphere group", file.spheres, f"contacts.{name}.first")
        _check_known(contact.second, "sphere group", file.spheres, f"contacts.{name}.second")
        _check_shape(file, name, contact)
    for name, obstacle in file.obstacles.items():
        for stopped in obstacle.spheres:
            _check_known(stopped, "sphere group", file.spheres, f"obstacles.{name}.spheres")
    for name, actuator in file.actuators.items():
        _check_rod(file, actuator.rod, f"actuators.{name}.rod")
    for name, spring in file.springs.items():
        _check_station(file, spring.first, f"springs.{name}.first")
        if isinstance(spring.second, Attachment):
            _check_station(file, spring.second, f"springs.{name}.second")
    for name, wrench in file.wrenches.items():
        _check_station(file, wrench, f"wrenches.{name}")
    if file.design is not None:
        _check_rod(file, file.design.rod, "design.rod")


def _check_shape(file: Tables, name: str, contact: Contact) -> None:
    if contact.shape == "spheres":
        return
    for other, spheres in file.contacts.items():
        if spheres.shape == "spheres" and contact.second in (spheres.first, spheres.second):
            tail = f'is "{contact.second}", whose spheres are used by {other}: define another'
            raise field_error(f"{tail} group for round cones", path=f"contacts.{name}.second")
    if contact.stiffness_per_length is not None:
        group = file.spheres[contact.first]
        for body in group.bodies:
            _check_rod(file, body, f"spheres.{contact.first}.bodies")
        if group.points:
            tail = f"has points, but {name} has a stiffness per length: use rods only"
            raise field_error(tail, path=f"spheres.{contact.first}")


def _check_known(name: str, kind: str, allowed: Iterable[str], path: str) -> None:
    names = list(allowed)
    if name not in names:
        raise field_error(f"refers to the {unknown_name(kind, name, names)}", path=path)


def _check_rod(file: Tables, name: str, path: str) -> None:
    _check_known(name, "body", file.bodies, path)
    if not isinstance(file.bodies[name], Rod):
        names = [f'"{n}"' for n, body in file.bodies.items() if isinstance(body, Rod)]
        rods = ", " + ", ".join(names) if names else ""
        raise field_error(f'is "{name}", which is a link: expected a rod{rods}', path=path)


def _check_station(file: Tables, station: Station, path: str) -> None:
    _check_known(station.body, "body", file.bodies, f"{path}.body")
    body, name = file.bodies[station.body], station.body
    if isinstance(body, Link):
        if station.point is not None:
            tail = f'is {station.point}: only rods have points, and "{name}" is a link'
            raise field_error(tail, path=f"{path}.point")
    elif station.at == "centroid":
        tail = f'is "centroid": only links support it, and "{name}" is a rod'
        raise field_error(tail, path=f"{path}.at")
    elif station.point is not None:
        if station.point >= body.sample_count:
            tail = f'is {station.point}: the points of "{name}" are 0 to {body.sample_count - 1}'
            raise field_error(tail, path=f"{path}.point")
    elif isinstance(station.at, float) and body.point_at(station.at) is None:
        tail = f'is {station.at!r}: on the rod "{name}" it must be a multiple of 1/{body.elements}'
        raise field_error(f"{tail} (an element boundary)", path=f"{path}.at")
