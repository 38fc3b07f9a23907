"""Passive torques of joints that are no linear springs."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from flexor.arrays import Array
from flexor.model import units
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.checks import check_known
from flexor.model.schema.force import Force
from flexor.model.schema.joint import coordinates_of
from flexor.model.schema.table import Choice, Name, PositiveNumber, Table, Text, one_of
from flexor.model.units import (
    Angle,
    AngularStiffness,
    Moment,
    NonNegativeMoment,
    PositiveAngle,
)
from flexor.model.validation import describe, field_error

KINDS = ("double-exponential", "table", "spastic")


class _Torque(Force):
    """A torque that resists the rotation of a joint, beside its stiffness and its limits."""

    description: ClassVar[str] = "joint_torques"

    kind: str
    body: Name
    coordinate: Text | None = None

    def check(self, path: str, system: BodySystem) -> None:
        """Check that the body has a joint with such an angle."""
        chosen_angle(self.body, self.coordinate, (f"{path}.body", f"{path}.coordinate"), system)

    def curve(self) -> dict[str, Any]:
        """Describe the torque as a function of the angle to the engine."""
        raise NotImplementedError

    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the torque to the engine."""
        return {
            "name": name,
            "body": self.body,
            "coordinate": chosen_angle(self.body, self.coordinate, (name, name), system),
            "curve": self.curve(),
        }


class Exponential(Table):
    """One end of a double exponential: ``moment`` at ``angle``, growing at ``rate`` [1/rad]."""

    moment: NonNegativeMoment
    rate: PositiveNumber
    angle: Angle


class DoubleExponential(_Torque):
    """The passive torque of joints as published: two exponentials, ``kind = "double-exponential"``.

    m(θ) = M₁ exp(r₁ (θ - θ₁)) - M₂ exp(-r₂ (θ - θ₂)) + M₀ resists a rotation; the first is
    ``flexion``, the second ``extension``, M₀ is ``offset``.
    """

    kind: Literal["double-exponential"]
    flexion: Exponential
    extension: Exponential
    offset: Moment = units.MOMENT.si(0.0)

    def curve(self) -> dict[str, Any]:
        """Describe the torque to the engine."""
        ends = (self.flexion, self.extension)
        moments = [*(float(end.moment) for end in ends), float(self.offset)]
        rates = [float(end.rate) for end in ends]
        angles = [float(end.angle) for end in ends]
        return {"double_exponential": {"moments": moments, "rates": rates, "angles": angles}}


class TorqueTable(_Torque):
    """A measured torque at increasing angles, ``kind = "table"``, a monotone cubic between them.

    Fritsch and Carlson's scheme, as SciPy's `PchipInterpolator`; beyond the first and the last
    angle the torque goes on with the slope that it has there.
    """

    kind: Literal["table"]
    angles: Annotated[tuple[Angle, ...], Field(min_length=2)]
    torques: Annotated[tuple[Moment, ...], Field(min_length=2)]

    @model_validator(mode="after")
    def _check(self) -> TorqueTable:
        if len(self.torques) != len(self.angles):
            tail = f"has {len(self.torques)} entries and angles {len(self.angles)}: give one each"
            raise field_error(tail, "torques")
        for k in range(1, len(self.angles)):
            if not self.angles[k] > self.angles[k - 1]:
                found = describe(getattr(self.angles[k], "text", self.angles[k]))
                raise field_error(f"is {found}: angles must increase", f"angles[{k}]")
        return self

    @cached_property
    def slopes(self) -> Array:
        """Derivative of the torque at each angle [N·m/rad]."""
        from scipy.interpolate import PchipInterpolator  # deferred: slow to import

        angles = np.array(self.angles, dtype=float)
        return np.asarray(PchipInterpolator(angles, np.array(self.torques)).derivative()(angles))

    def curve(self) -> dict[str, Any]:
        """Describe the torque to the engine."""
        angles, torques = ([float(value) for value in each] for each in (self.angles, self.torques))
        return {"table": {"angles": angles, "torques": torques, "slopes": self.slopes.tolist()}}


class Spastic(_Torque):
    """Stiffness that sets in at an angle in one direction, ``kind = "spastic"``.

    Beyond ``threshold`` by s the torque is k s²/(2w) up to s = w, and k (s - w/2) from there on:
    the stretch reflex at rest, k being ``stiffness`` and w ``width``.
    """

    kind: Literal["spastic"]
    threshold: Angle
    stiffness: AngularStiffness
    width: PositiveAngle = units.Quantity(0.08726646259971647, "5 deg")
    resists: Annotated[Literal["flexion", "extension"], Choice("flexion", "extension")] = "flexion"

    def curve(self) -> dict[str, Any]:
        """Describe the torque to the engine."""
        return {
            "threshold": {
                "angle": float(self.threshold),
                "stiffness": float(self.stiffness),
                "width": float(self.width),
                "direction": 1.0 if self.resists == "flexion" else -1.0,
            }
        }


def chosen_angle(
    body: str, coordinate: str | None, paths: tuple[str, str], system: BodySystem
) -> str:
    """Return the angle of a body's joint that is meant; an error names the field if there is none.

    Parameters
    ----------
    body
        The body that the joint carries.
    coordinate
        Such as ``"theta_y"``; the only angle of the joint unless given.
    paths
        Of the fields with the body and the coordinate, for messages.
    system
        The bodies.
    """
    check_known(body, "body", system.bodies, paths[0])
    joint = system.bodies[body].joint
    angles = coordinates_of(joint, system.planar)
    if not angles:
        tail = f'is "{body}", which is carried by a {joint.kind} joint: it has no angle'
        raise field_error(tail, paths[0])
    if coordinate is None:
        if len(angles) > 1:
            listed = ", ".join(f'"{each}"' for each in angles)
            tail = f'is missing: the joint of "{body}" has {listed}'
            raise field_error(tail, paths[1])
        return angles[0]
    check_known(coordinate, "angle", dict.fromkeys(angles), paths[1])
    return coordinate


def _form(value: object) -> str:
    kind = value.get("kind") if isinstance(value, Mapping) else getattr(value, "kind", None)
    return str(kind)


Torque = Annotated[
    Annotated[DoubleExponential, Tag("double-exponential")]
    | Annotated[TorqueTable, Tag("table")]
    | Annotated[Spastic, Tag("spastic")],
    Discriminator(_form),
    BeforeValidator(one_of(*KINDS)),
]
