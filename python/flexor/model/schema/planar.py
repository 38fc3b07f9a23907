"""Checks of planar models, which lie in the x-z plane and rotate about y."""

from __future__ import annotations

from flexor.model.schema.actuator import Actuator, Curve
from flexor.model.schema.body import Body, Rod
from flexor.model.schema.joint import FixedJoint, FreeJoint, Joint, PrismaticJoint, RevoluteJoint
from flexor.model.schema.points import Attachment
from flexor.model.schema.strain import PLANAR_MODES
from flexor.model.schema.tables import Tables
from flexor.model.schema.vector import Vector
from flexor.model.validation import field_error


def check_planar(file: Tables) -> None:
    """Reject anything that leaves the plane.

    Parameters
    ----------
    file
        A model file with ``planar = true``.
    """
    _in_plane(file.gravity, "gravity")
    for name, body in file.bodies.items():
        _check_body(body, f"bodies.{name}")
    for name, obstacle in file.obstacles.items():
        _in_plane(obstacle.point, f"obstacles.{name}.point")
        if obstacle.normal[1] != 0.0:
            tail = "in a planar model it must lie in the x-z plane"
            raise field_error(f"is {list(obstacle.normal)}: {tail}", f"obstacles.{name}.normal")
    for name, actuator in file.actuators.items():
        _check_actuator(actuator, f"actuators.{name}")
    for name, spring in file.springs.items():
        _in_plane(spring.first.offset, f"springs.{name}.first.offset")
        if isinstance(spring.second, Attachment):
            _in_plane(spring.second.offset, f"springs.{name}.second.offset")
        else:
            _in_plane(spring.second.world, f"springs.{name}.second.world")
    for name, wrench in file.wrenches.items():
        _in_plane(wrench.offset, f"wrenches.{name}.offset")
        _in_plane(wrench.force, f"wrenches.{name}.force")
        _about_y(wrench.moment, f"wrenches.{name}.moment")


def _check_body(body: Body, path: str) -> None:
    if body.placement.y != 0.0:
        _reject(body.placement.y, f"{path}.placement.y")
    _about_y(body.placement.rotation, f"{path}.placement.rotation")
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
        if getattr(body.reference_strain, mode) != 0.0:
            _reject(getattr(body.reference_strain, mode), f"{path}.reference_strain.{mode}")


def _check_joint(joint: Joint, path: str) -> None:
    if isinstance(joint, (FixedJoint, FreeJoint)):
        return
    if isinstance(joint, RevoluteJoint):
        if joint.axis[0] != 0.0 or joint.axis[2] != 0.0:
            raise field_error(
                f"is {list(joint.axis)}: in a planar model it must be y", f"{path}.axis"
            )
    elif isinstance(joint, PrismaticJoint):
        if joint.axis[1] != 0.0:
            tail = f"is {list(joint.axis)}: in a planar model it must lie in the x-z plane"
            raise field_error(tail, f"{path}.axis")
    else:
        tail = (
            f'is "{joint.kind}": planar models support fixed, revolute, prismatic and free joints'
        )
        raise field_error(tail, f"{path}.kind")


def _check_actuator(actuator: Actuator, path: str) -> None:
    if not isinstance(actuator.path, Curve):
        raise field_error("is a helix, which is not planar", f"{path}.path")
    for offset in actuator.path.y:
        if offset != 0.0:
            _reject(offset, f"{path}.path.y")
    if actuator.lever.y != 0.0:
        _reject(actuator.lever.y, f"{path}.lever.y")


def _in_plane(vector: Vector, path: str) -> None:
    if vector.y != 0.0:
        _reject(vector.y, f"{path}.y")


def _about_y(vector: Vector, path: str) -> None:
    for axis in ("x", "z"):
        if getattr(vector, axis) != 0.0:
            _reject(getattr(vector, axis), f"{path}.{axis}")


def _reject(value: float, path: str) -> None:
    text = getattr(value, "text", None)
    quoted = f'"{text}"' if text else repr(value)
    raise field_error(f"is {quoted}: it must be zero in a planar (x-z) model", path)
