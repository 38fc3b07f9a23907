"""Chambers and cables along a rod."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Tag

from flexor.arrays import Array
from flexor.model import units
from flexor.model.schema.body_system import BodySystem
from flexor.model.schema.checks import check_rod
from flexor.model.schema.force import Force
from flexor.model.schema.planar import at_zero
from flexor.model.schema.profile import interpolated
from flexor.model.schema.table import Choice, Name, Number, Table
from flexor.model.units import Angle, Length, PositiveLength
from flexor.model.validation import field_error


def _expand(value: object) -> object:
    return (value,) if isinstance(value, (str, int, float)) else value


Offsets = Annotated[tuple[Length, ...], Field(min_length=1), BeforeValidator(_expand)]


class Curve(Table):
    """Offset from the rod's axis: a constant, or equally spaced samples from base to tip."""

    y: Offsets = (units.LENGTH.si(0.0),)
    z: Offsets = (units.LENGTH.si(0.0),)

    def sampled(self, points: Array) -> tuple[Array, Array]:
        """Return the offset (y, z) and its derivative with respect to X, each (P, 2) [m]."""
        columns = [_column(samples, points) for samples in (self.y, self.z)]
        return (
            np.stack([value for value, _ in columns], axis=1),
            np.stack([slope for _, slope in columns], axis=1),
        )


class Helix(Table):
    """A helix about the rod's axis: (y, z) = radius (cos φ, sin φ) with φ = start + turn X."""

    radius: PositiveLength
    start: Angle = units.ANGLE.si(0.0)
    turn: Angle

    def sampled(self, points: Array) -> tuple[Array, Array]:
        """Return the offset (y, z) and its derivative with respect to X, each (P, 2) [m]."""
        angle = self.start + self.turn * points
        cosine, sine = np.cos(angle), np.sin(angle)
        offset = self.radius * np.stack([cosine, sine], axis=1)
        return offset, self.radius * self.turn * np.stack([-sine, cosine], axis=1)


def _column(samples: tuple[float, ...], points: Array) -> tuple[Array, Array]:
    if len(samples) == 1:
        return np.full_like(points, float(samples[0])), np.zeros_like(points)
    return interpolated(samples, points)


def _form(value: object) -> str:
    helix = isinstance(value, Helix) or (isinstance(value, dict) and "radius" in value)
    return "helix" if helix else "curve"


class Lever(Table):
    """Offset from the rod's axis in multiples of the surface S(X)."""

    y: Number = 0.0
    z: Number = 0.0


def _lever(value: object) -> object:
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return {"z": value}
    return value


class Actuator(Force):
    """A chamber (u > 0 elongates it) or a cable (u > 0 is its tension) along a rod.

    Its offset from the axis is ``path`` + ``lever`` S(X). A scalar lever is along z, so that 1 is
    on the dorsal surface. With ``control = "length"`` its loads are changes of length from the
    reference state: the elongation of a chamber, the shortening of a cable.
    """

    description: ClassVar[str] = "actuators"

    kind: Annotated[Literal["chamber", "cable"], Choice("chamber", "cable", "pressure")]
    rod: Name
    path: Annotated[
        Annotated[Curve, Tag("curve")] | Annotated[Helix, Tag("helix")], Discriminator(_form)
    ] = Curve()
    lever: Annotated[Lever, BeforeValidator(_lever)] = Lever()
    control: Annotated[Literal["force", "length"], Choice("force", "length")] = "force"

    @property
    def loads(self) -> units.Dimension:
        """Dimension of its loads."""
        if self.control == "force":
            return self.applied
        return units.LENGTHENING if self.kind == "chamber" else units.SHORTENING

    @property
    def applied(self) -> units.Dimension:
        """Dimension of the force with which it acts."""
        return units.FORCE

    def check(self, path: str, system: BodySystem) -> None:
        """Check that the rod exists."""
        check_rod(self.rod, system.bodies, f"{path}.rod")

    def check_planar(self, path: str) -> None:
        """Reject a path outside the plane."""
        if not isinstance(self.path, Curve):
            raise field_error("is a helix, which is not planar", f"{path}.path")
        for offset in self.path.y:
            at_zero(offset, f"{path}.path.y")
        at_zero(self.lever.y, f"{path}.lever.y")

    def lower(self, name: str, system: BodySystem) -> dict[str, Any]:
        """Describe the actuator to the engine, at the sample points of its rod."""
        path, slope = self.path.sampled(system.rod(self.rod).sample_points)
        return {
            "name": name,
            "kind": self.kind,
            "rod": self.rod,
            "path": path.tolist(),
            "path_slope": slope.tolist(),
            "lever": [self.lever.y, self.lever.z],
        }
