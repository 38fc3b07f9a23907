"""A rigid tree in Pinocchio: the reference side of `rigid_trees`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .report import load

Array = NDArray[np.float64]
Triple = tuple[float, float, float]


@dataclass(frozen=True)
class RigidBody:
    """A conical frustum along x, hung by a joint at its parent's tip.

    Attributes
    ----------
    name, parent : str
        Its name and its parent's, None for the world.
    length, radii
        Length, and radii at joint and tip [m].
    place, turn : triples
        Translation [m] and rotation vector [rad] of the joint in the frame of the parent's tip.
    kind, axis
        Joint, as in a model file.
    """

    name: str
    parent: str | None
    length: float
    radii: tuple[float, float]
    place: Triple
    turn: Triple
    kind: str
    axis: Triple = (0.0, 1.0, 0.0)

    @property
    def volume(self) -> float:
        """Volume of the frustum [m³]."""
        a, b = self.radii
        return float(np.pi / 3.0 * self.length * (a * a + a * b + b * b))

    @property
    def centroid(self) -> float:
        """Distance of the centroid from the joint [m]."""
        a, b = self.radii
        return self.length * (a * a + 2 * a * b + 3 * b * b) / (4.0 * (a * a + a * b + b * b))


@dataclass(frozen=True)
class PointSpring:
    """A spring between a point of a body and one of another body or of the world.

    Attributes
    ----------
    body, offset
        Body and place in the frame of its tip [m].
    other, place
        The other body (None for the world), and the place in the frame of its tip [m].
    stiffness, rest, slack
        [N/m], [m], and whether it only pulls.
    """

    body: str
    offset: Triple
    other: str | None
    place: Triple
    stiffness: float
    rest: float
    slack: bool = False


class PinocchioTree:
    """A rigid tree in Pinocchio, in Flexor's coordinates.

    Rotations are measured by rotation vectors and free motions by twists [angular; linear], of
    which Pinocchio knows exponential and Jacobian.
    """

    def __init__(self, bodies: Sequence[RigidBody], gravity: Triple, density: float) -> None:
        pin = self.pin = load("pin", "pinocchio")
        self.bodies = {body.name: body for body in bodies}
        self.model = pin.Model()
        self.model.gravity.linear = np.array(gravity)
        self.joints: dict[str, int] = {}
        self.kinds: list[str] = []
        for body in bodies:
            self._add(body, density)
        self.data = self.model.createData()

    def _add(self, body: RigidBody, density: float) -> None:
        pin = self.pin
        place = pin.SE3(pin.exp3(np.array(body.turn)), np.array(body.place))
        parent = 0
        if body.parent is not None:
            reach = np.array([self.bodies[body.parent].length, 0.0, 0.0])
            place, parent = pin.SE3(np.eye(3), reach) * place, self.joints[body.parent]
        axis = np.array(body.axis)
        joints: dict[str, list[Any]] = {
            "revolute": [pin.JointModelRevoluteUnaligned(axis)],
            "prismatic": [pin.JointModelPrismaticUnaligned(axis)],
            "universal": [pin.JointModelRY(), pin.JointModelRZ()],
            "spherical": [pin.JointModelSpherical()],
            "free": [pin.JointModelFreeFlyer()],
        }
        for i, joint in enumerate(joints[body.kind]):
            parent = self.model.addJoint(parent, joint, place, f"{body.name}.{i}")
            place = pin.SE3.Identity()
            self.kinds.append(body.kind)
        self.joints[body.name] = parent
        inertia = pin.Inertia(density * body.volume, np.array([body.centroid, 0.0, 0.0]), np.eye(3))
        self.model.appendBodyToJoint(parent, inertia, pin.SE3.Identity())

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.model.nv)

    def _configuration(self, q: Array) -> tuple[Array, Array]:
        """Pinocchio's configuration, and the rate of its velocities with Flexor's coordinates."""
        pin, start, parts = self.pin, 0, []
        rate = np.zeros((self.size, self.size))
        for kind in self.kinds:
            width = {"spherical": 3, "free": 6}.get(kind, 1)
            own = q[start : start + width]
            block = slice(start, start + width)
            if kind == "spherical":
                parts.append(pin.Quaternion(pin.exp3(own)).coeffs())
                rate[block, block] = pin.Jexp3(own)
            elif kind == "free":
                turned = pin.exp3(own[:3])
                parts.append(pin.SE3ToXYZQUAT(pin.SE3(turned, own[3:])))
                # Pinocchio has [linear; angular], both in the frame of the body.
                rate[start : start + 3, start + 3 : start + 6] = turned.T
                rate[start + 3 : start + 6, start : start + 3] = pin.Jexp3(own[:3])
            else:
                parts.append(own)
                rate[block, block] = 1.0
            start += width
        return np.concatenate(parts), rate

    def tips(self, q: Array) -> dict[str, Array]:
        """Return the frames of all tips, (4, 4) each."""
        self.pin.forwardKinematics(self.model, self.data, self._configuration(q)[0])
        poses = {}
        for name, joint in self.joints.items():
            reach = self.pin.SE3(np.eye(3), np.array([self.bodies[name].length, 0.0, 0.0]))
            poses[name] = np.asarray((self.data.oMi[joint] * reach).homogeneous)
        return poses

    def jacobian(self, q: Array, name: str, offset: Triple = (0.0, 0.0, 0.0)) -> Array:
        """Return the Jacobian of a point near a tip, (6, n): [angular; linear] in world axes."""
        pin = self.pin
        configuration, rate = self._configuration(q)
        shift = np.array(offset) + np.array([self.bodies[name].length, 0.0, 0.0])
        frame = pin.Frame("", self.joints[name], pin.SE3(np.eye(3), shift), pin.FrameType.OP_FRAME)
        model = self.model.copy()
        index = model.addFrame(frame)
        found = pin.computeFrameJacobian(
            model, model.createData(), configuration, index, pin.LOCAL_WORLD_ALIGNED
        )
        return np.asarray(found[[3, 4, 5, 0, 1, 2]] @ rate)

    def gravity_torque(self, q: Array) -> Array:
        """Return the derivative of the potential energy of gravity, (n,)."""
        configuration, rate = self._configuration(q)
        torque = self.pin.computeGeneralizedGravity(self.model, self.data, configuration)
        return np.asarray(rate.T @ torque)

    def gravity_energy(self, q: Array) -> float:
        """Return the potential energy of gravity [J]."""
        return float(
            self.pin.computePotentialEnergy(self.model, self.data, self._configuration(q)[0])
        )

    def gravity_tangent(self, q: Array) -> Array:
        """Return the second derivative for trees of revolute and prismatic joints, (n, n)."""
        configuration, _ = self._configuration(q)
        return np.asarray(
            self.pin.computeGeneralizedGravityDerivatives(self.model, self.data, configuration)
        )

    def spring_torque(self, q: Array, springs: Sequence[PointSpring]) -> Array:
        """Return the derivative of the springs' energy, (n,)."""
        poses, total = self.tips(q), np.zeros(self.size)
        for spring in springs:
            point = (poses[spring.body] @ [*spring.offset, 1.0])[:3]
            motion = self.jacobian(q, spring.body, spring.offset)[3:]
            end = np.array(spring.place)
            if spring.other is not None:
                end = (poses[spring.other] @ [*spring.place, 1.0])[:3]
                motion = motion - self.jacobian(q, spring.other, spring.place)[3:]
            length = float(np.linalg.norm(point - end))
            stretch = length - spring.rest
            if not (spring.slack and stretch <= 0.0):
                total += spring.stiffness * stretch / length * (point - end) @ motion
        return total
