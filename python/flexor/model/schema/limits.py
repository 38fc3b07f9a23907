"""Limits of a model's size, so that a short file cannot ask for unbounded time and memory."""

from __future__ import annotations

from collections.abc import Mapping

from flexor.model.schema.actuator import Actuator
from flexor.model.schema.body import Body, Rod
from flexor.model.schema.contact import Contact
from flexor.model.schema.points import SphereGroup
from flexor.model.schema.pressure import Pressure
from flexor.model.validation import field_error

MAX_BODIES = 2_000
MAX_POINTS = 200_000
MAX_PAIRS = 2_000_000


def check_size(
    bodies: Mapping[str, Body],
    spheres: Mapping[str, SphereGroup],
    contacts: Mapping[str, Contact],
    actuators: Mapping[str, Actuator | Pressure],
) -> None:
    """Check the numbers of bodies, sample points and pairs of spheres.

    Parameters
    ----------
    bodies, spheres, contacts, actuators
        Tables of a model file whose references resolve.
    """
    if len(bodies) > MAX_BODIES:
        raise field_error(f"has {len(bodies):,} entries: at most {MAX_BODIES:,}", "bodies")
    rods = {name: body for name, body in bodies.items() if isinstance(body, Rod)}
    points = sum(rod.sample_count for rod in rods.values())
    points += sum(rods[each.rod].sample_count for each in actuators.values())
    if points > MAX_POINTS:
        tail = f"have {points:,} sample points, counted again for each actuator: at most"
        raise field_error(f"{tail} {MAX_POINTS:,}", "bodies")
    counts = {
        name: len(group.points)
        + sum(rods[body].sample_count + 1 if body in rods else 2 for body in group.bodies)
        for name, group in spheres.items()
    }
    pairs = 0
    for name, contact in contacts.items():
        pairs += counts[contact.first] * counts[contact.second]
        if pairs > MAX_PAIRS:
            tail = f"has too many pairs of spheres: all contacts together at most {MAX_PAIRS:,}"
            raise field_error(tail, path=f"contacts.{name}")
