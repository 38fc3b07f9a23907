"""Joints between a body and its parent."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from flexor.model import units
from flexor.model.schema.table import Table, one_of
from flexor.model.schema.vector import Axis
from flexor.model.units import (
    Angle,
    AngularStiffness,
    Length,
    PositiveAngle,
    PositiveAngularStiffness,
    PositiveLength,
    PositiveStiffness,
    Stiffness,
)
from flexor.model.validation import field_error


def _repeated(count: int) -> BeforeValidator:
    def repeat(value: object) -> object:
        if isinstance(value, str):
            return (value,) * count
        if isinstance(value, Sequence) and len(value) != count:
            raise field_error(f"has {len(value)} entries: expected one, or a list of {count}")
        return value

    return BeforeValidator(repeat)


AngularStiffnesses = Annotated[
    tuple[AngularStiffness, AngularStiffness, AngularStiffness], _repeated(3)
]
_NO_STIFFNESS = units.STIFFNESS.si(0.0)
_NO_ANGULAR_STIFFNESS = units.ANGULAR_STIFFNESS.si(0.0)


class FixedJoint(Table):
    """No motion between the body and its parent."""

    kind: Literal["fixed"]


class RevoluteJoint(Table):
    """Rotation about one axis.

    At a distance s beyond a limit, the limit's energy is k s³/(6w) for s <= w and
    k (s²/2 - w s/2 + w²/6) for s > w, with k (s - 10 w)⁴/(12 w²) added for s > 10 w, which is
    twice continuously differentiable; k is the ``limit_stiffness`` and w the ``limit_width``.
    """

    kind: Literal["revolute"]
    axis: Axis = (0.0, 1.0, 0.0)
    stiffness: AngularStiffness = _NO_ANGULAR_STIFFNESS
    rest: Angle = units.ANGLE.si(0.0)
    lower: Angle | None = None
    upper: Angle | None = None
    limit_stiffness: PositiveAngularStiffness = units.Quantity(10.0, "10 N*m/rad")
    limit_width: PositiveAngle = units.Quantity(0.017453292519943295, "1 deg")

    @model_validator(mode="after")
    def _check(self) -> RevoluteJoint:
        _check_axis(self.axis)
        _check_limits(self.lower, self.upper)
        return self


class PrismaticJoint(Table):
    """Translation along one axis; limits as for the revolute joint."""

    kind: Literal["prismatic"]
    axis: Axis = (1.0, 0.0, 0.0)
    stiffness: Stiffness = _NO_STIFFNESS
    rest: Length = units.LENGTH.si(0.0)
    lower: Length | None = None
    upper: Length | None = None
    limit_stiffness: PositiveStiffness = units.Quantity(1e4, "10 N/mm")
    limit_width: PositiveLength = units.Quantity(1e-3, "1 mm")

    @model_validator(mode="after")
    def _check(self) -> PrismaticJoint:
        _check_axis(self.axis)
        _check_limits(self.lower, self.upper)
        return self


class UniversalJoint(Table):
    """Rotation about the body's y axis and then about its z axis."""

    kind: Literal["universal"]
    stiffness: Annotated[tuple[AngularStiffness, AngularStiffness], _repeated(2)] = (
        _NO_ANGULAR_STIFFNESS,
    ) * 2


class SphericalJoint(Table):
    """Arbitrary rotation, with the rotation vector as coordinates."""

    kind: Literal["spherical"]
    stiffness: AngularStiffnesses = (_NO_ANGULAR_STIFFNESS,) * 3


class FreeJoint(Table):
    """Arbitrary rigid motion: a translation, and then a rotation with its vector as coordinates.

    Its coordinates are three rotations and three translations, in a planar model one rotation,
    about y, and two translations.
    """

    kind: Literal["free"]
    stiffness: AngularStiffnesses = (_NO_ANGULAR_STIFFNESS,) * 3
    linear_stiffness: Annotated[tuple[Stiffness, Stiffness, Stiffness], _repeated(3)] = (
        _NO_STIFFNESS,
    ) * 3


Joint = Annotated[
    FixedJoint | RevoluteJoint | PrismaticJoint | UniversalJoint | SphericalJoint | FreeJoint,
    Field(discriminator="kind"),
    BeforeValidator(one_of("fixed", "revolute", "prismatic", "universal", "spherical", "free")),
]


def coordinates_of(joint: Joint, planar: bool) -> tuple[str, ...]:
    """Return the names of the angles of a joint, as the engine calls them."""
    if planar and joint.kind == "free":
        return ("theta_y",)
    every = ("theta_x", "theta_y", "theta_z")
    angles: dict[str, tuple[str, ...]] = {
        "revolute": ("theta",),
        "universal": every[1:],
        "spherical": every,
        "free": every,
    }
    return angles.get(joint.kind, ())


def _check_axis(axis: tuple[float, float, float]) -> None:
    if not any(axis):
        raise field_error("is zero: it must not be", path="axis")


def _check_limits(lower: float | None, upper: float | None) -> None:
    if lower is not None and upper is not None and not lower < upper:
        low, high = (getattr(limit, "text", limit) for limit in (lower, upper))
        raise field_error(f'is "{low}": it must be below the upper limit, "{high}"', path="lower")
