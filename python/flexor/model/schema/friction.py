"""Coulomb friction where bodies press on each other, and of tendons in their guides."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

from flexor.model.schema.body import Rod
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.contact import Contact
from flexor.model.schema.foundation import lower_self_contact, lower_skins
from flexor.model.schema.obstacle import Obstacle
from flexor.model.schema.tendon import Tendon

if TYPE_CHECKING:
    from flexor.model.schema.model_file import ModelFile


class Friction(NamedTuple):
    """Friction in a contact, on an obstacle, or of the skin of a rod."""

    table: str  # of the file
    entry: str  # in that table
    described: dict[str, Any]  # to the engine


def frictions(system: BodySystem) -> Iterator[Friction]:
    """Yield the frictions of contacts of a file, in the order in which the engine counts them."""
    for kind in (Contact, Obstacle):
        for table, name, each in system.entries(kind):
            if isinstance(each, (Contact, Obstacle)) and each.friction > 0.0:
                described = {"name": name, "coefficient": float(each.friction)}
                if each.stiffness_ratio is not None:
                    described["stiffness_ratio"] = float(each.stiffness_ratio)
                yield Friction(table, name, described)
    rods = {name: body for name, body in system.bodies.items() if isinstance(body, Rod)}
    if not any(rod.friction > 0.0 for rod in rods.values()):
        return
    found = [each["name"] for _, each in (*lower_skins(system), *lower_self_contact(system))]
    for name, body in rods.items():
        for own in (f"{name}.skin", f"{name}.self"):
            if body.friction > 0.0 and own in found:
                described = {"name": own, "coefficient": float(body.friction)}
                yield Friction("bodies", name, described)


def coefficient(name: str, file: ModelFile) -> float:
    """Return the coefficient of a friction, which may be zero, by its name to the engine."""
    own = file.contacts.get(name) or file.obstacles.get(name)
    return float((own or file.rod(name.rpartition(".")[0])).friction)


def rough_tendons(system: BodySystem) -> Iterator[str]:
    """Yield the names of tendons with friction, which the engine counts after the contacts."""
    for _, name, each in system.entries(Tendon):  # type: ignore[type-abstract]
        if isinstance(each, Tendon) and each.friction > 0.0:
            yield name
