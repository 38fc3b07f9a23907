"""The limbs of a model, such as the fingers of a hand."""

from __future__ import annotations

from flexor.model.structure import Structure


def limbs(model: Structure) -> int:
    """Return the number of chains of joints that turn, such as fingers on a hand that is fixed."""
    bodies = model.file.bodies
    turning = set(model.angular_joints)
    carriers = {each["body"] for each in model.engine.joints if each["name"] in turning}
    first = 0
    for name in carriers:
        above = bodies[name].parent
        while above is not None and above not in carriers:
            above = bodies[above].parent
        first += above is None
    return first
