"""Checks of planar models, which lie in the x-z plane and rotate about y."""

from __future__ import annotations

from flexor.model.schema.body import Body, Rod
from flexor.model.schema.joint import FixedJoint, FreeJoint, Joint, PrismaticJoint, RevoluteJoint
from flexor.model.schema.strain import PLANAR_MODES
from flexor.model.schema.vector import Vector, shown
from flexor.model.validation import field_error


def check_planar_body(body: Body, path: str) -> None:
    """Reject a body that leaves the plane."""
    at_zero(body.placement.y, f"{path}.placement.y")
    about_y(body.placement.rotation, f"{path}.placement.rotation")
    _check_joint(body.joint, f"{path}.joint")
    if not isinstance(body, Rod):
        return
    for mode in body.strain.modes:
        if mode not in PLANAR_MODES:
            raise field_error(
                f"is not planar: expected one of {', '.join(PLANAR_MODES)}",
                path=f"{path}.strain.{mode}",
            )
    for mode in ("twist_x", "bend_z", "shear_y"):
        at_zero(getattr(body.reference_strain, mode), f"{path}.reference_strain.{mode}")


def _check_joint(joint: Joint, path: str) -> None:
    if isinstance(joint, (FixedJoint, FreeJoint)):
        return
    if isinstance(joint, RevoluteJoint):
        if joint.axis[0] != 0.0 or joint.axis[2] != 0.0:
            raise field_error(
                f"is {shown(joint.axis)}: in a planar model it must be y", f"{path}.axis"
            )
    elif isinstance(joint, PrismaticJoint):
        if joint.axis[1] != 0.0:
            tail = f"is {shown(joint.axis)}: in a planar model it must lie in the x-z plane"
            raise field_error(tail, f"{path}.axis")
    else:
        tail = (
            f'is "{joint.kind}": planar models support fixed, revolute, prismatic and free joints'
        )
        raise field_error(tail, f"{path}.kind")


def in_plane(vector: Vector, path: str) -> None:
    """Reject a vector outside the plane; ``path`` names it in the message."""
    at_zero(vector.y, f"{path}.y")


def about_y(vector: Vector, path: str) -> None:
    """Reject a rotation or moment that is not about y; ``path`` names it in the message."""
    at_zero(vector.x, f"{path}.x")
    at_zero(vector.z, f"{path}.z")


def at_zero(value: float, path: str) -> None:
    """Reject a component other than zero; ``path`` names it in the message."""
    if value != 0.0:
        text = getattr(value, "text", None)
        quoted = f'"{text}"' if text else repr(value)
        raise field_error(f"is {quoted}: it must be zero in a planar (x-z) model", path)
