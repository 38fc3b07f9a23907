"""A limb as MJCF and URDF describe one: bodies with joints, shapes and points, and tendons."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from flexor.arrays import Array

JointKind = Literal["hinge", "slide", "ball", "free"]
ShapeKind = Literal["sphere", "capsule", "cylinder", "other"]


@dataclass(frozen=True, eq=False)
class Pose:
    """Where something is in the frame of its body."""

    place: Array  # (3,) [m]
    turn: Array  # (3, 3): its axes are the columns

    def of(self, inner: Pose) -> Pose:
        """Return the pose of something that is given in this one."""
        return Pose(self.place + self.turn @ inner.place, self.turn @ inner.turn)


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint of a body; several move it one after another, the first outermost."""

    name: str
    kind: JointKind
    place: Array  # (3,): a point that it does not move, in the body's frame [m]
    axis: Array  # (3,): in the body's frame
    lower: float | None = None  # from where the body is drawn [rad or m]
    upper: float | None = None
    stiffness: float = 0.0  # [N·m/rad or N/m]
    rest: float = 0.0


@dataclass(frozen=True, eq=False)
class Shape:
    """A solid on a body; a capsule or a cylinder along the z axis of its pose."""

    name: str
    kind: ShapeKind
    pose: Pose
    radius: float  # [m]
    length: float  # of the cylindrical part [m]
    touches: bool  # whether contact is with it


@dataclass(eq=False)
class Body:
    """A rigid body."""

    name: str
    parent: str | None
    pose: Pose  # in the parent's frame
    joints: list[Joint] = field(default_factory=list)
    shapes: list[Shape] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Point:
    """A named point of a body, or of the world."""

    body: str | None
    place: Array  # (3,) [m]


@dataclass(frozen=True)
class Over:
    """A shape that a tendon may touch, and a point on the side on which it passes."""

    shape: str
    side: str | None


@dataclass(frozen=True)
class Muscle:
    """The numbers of a muscle."""

    max_force: float  # [N]
    optimal_length: float  # [m]
    tendon_slack_length: float  # [m]
    lower: float
    upper: float
    passive: float  # at the length ``upper``, by the largest active force


@dataclass(eq=False)
class Tendon:
    """A tendon: names of points, shapes to pass around, and divisors where branches begin."""

    name: str
    stages: list[str | Over | float]
    muscle: Muscle | None = None
    pulled: bool = False  # by an actuator that is no muscle
    stiffness: float = 0.0  # [N/m]
    slack_length: float | None = None  # [m]


@dataclass(eq=False)
class Limb:
    """A limb, and what a file says besides.

    Attributes
    ----------
    left_out : Counter
        What was not carried over, in words, with how often.
    """

    name: str
    bodies: dict[str, Body] = field(default_factory=dict)
    points: dict[str, Point] = field(default_factory=dict)
    tendons: list[Tendon] = field(default_factory=list)
    world_shapes: list[Shape] = field(default_factory=list)
    gravity: Array = field(default_factory=lambda: np.zeros(3))
    left_out: Counter[str] = field(default_factory=Counter)

    def shape(self, name: str) -> tuple[str | None, Shape] | None:
        """Return the body of a shape, None for the world, and the shape."""
        for each in self.world_shapes:
            if each.name == name:
                return None, each
        for body in self.bodies.values():
            for each in body.shapes:
                if each.name == name:
                    return body.name, each
        return None
