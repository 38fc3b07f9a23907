"""Bodies: soft rods and rigid links."""

from __future__ import annotations

from functools import cached_property, lru_cache
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, PrivateAttr, model_validator

from flexor import _engine
from flexor.arrays import Array
from flexor.model import units
from flexor.model.schema.joint import FixedJoint, Joint
from flexor.model.schema.profile import LinkRadius, RodRadius, SampledSurface, surface
from flexor.model.schema.section import Section, Sections, Solid
from flexor.model.schema.skin import Skin
from flexor.model.schema.strain import ELEMENT_DEGREE, ReferenceStrain, Strain
from flexor.model.schema.table import Choice, Count, Name, NonNegativeNumber, Switch, Table, one_of
from flexor.model.schema.vector import Rotation
from flexor.model.units import Density, Length, PositiveLength, PositiveModulus
from flexor.model.validation import describe, field_error

TIP_INTERVALS = 3  # of a rod with a skin


class Placement(Table):
    """Pose of a body's base in the frame of its parent's tip (or in the world).

    ``reference`` selects what is placed: the body's ``"axis"`` or its ``"underside"``. With
    ``"underside"`` the axis of a rod lies S(0) above the given point, so that a rod stays on the
    surface that it rests on when its radius changes.
    """

    x: Length = units.LENGTH.si(0.0)
    y: Length = units.LENGTH.si(0.0)
    z: Length = units.LENGTH.si(0.0)
    rotation: Rotation = Rotation()
    reference: Annotated[Literal["axis", "underside"], Choice("axis", "underside")] = "axis"

    @property
    def dorsal(self) -> Array:
        """The local z axis in the parent's frame; shape (3,)."""
        vector = np.array(self.rotation.components)
        angle = float(np.linalg.norm(vector))
        up = np.array([0.0, 0.0, 1.0])
        if angle == 0.0:
            return up
        axis = vector / angle
        along = axis * axis[2]  # Rodrigues' formula
        return np.asarray(along + np.cos(angle) * (up - along) + np.sin(angle) * np.cross(axis, up))


def _magnus(value: object) -> object:
    if value not in (2, 4):
        raise field_error(f"is {describe(value)}: expected 2 or 4")
    return value


class Rod(Table):
    """A soft body: a Cosserat rod with geometric variable strain (1)-(7)."""

    kind: Literal["rod"]
    parent: Name | None = None
    placement: Placement = Placement()
    joint: Joint = FixedJoint(kind="fixed")
    length: PositiveLength
    radius: RodRadius
    section: Sections = Solid(kind="circular")
    material: Name | None = None
    skin: Skin | None = None
    friction: NonNegativeNumber = 0.0
    tip: PositiveLength | None = None
    self_contact: Switch | None = None
    young_modulus: PositiveModulus | None = None
    poisson_ratio: (
        Annotated[float, Field(strict=True, gt=-1.0, le=0.5, allow_inf_nan=False)] | None
    ) = None
    density: Density = units.DENSITY.si(0.0)
    strain: Strain
    reference_strain: ReferenceStrain = ReferenceStrain()
    elements: Annotated[Count, Field(le=1000)] = 1
    tip_intervals: Annotated[Count, Field(le=100)] | None = None
    gauss_points: Annotated[Count, Field(le=30)]
    magnus_order: Annotated[Literal[2, 4], BeforeValidator(_magnus)] = 4
    _points_across: tuple[int, ...] | None = PrivateAttr(None)

    @model_validator(mode="after")
    def _check_material(self) -> Rod:
        """Check that there is one description of the material."""
        own = self.material is None and isinstance(self.section, Solid)
        for key, hint in (("young_modulus", f": {units.MODULUS.hint}"), ("poisson_ratio", "")):
            if own and getattr(self, key) is None:
                raise field_error(f"is missing{hint}", path=key)
            if not own and getattr(self, key) is not None:
                tail = "is given, but the section is made of [materials] or of stiffness"
                raise field_error(tail, path=key)
        if not own and self.density > 0.0:
            raise field_error("is given, but the mass is that of the section", path="density")
        return self

    @model_validator(mode="after")
    def _check_tip(self) -> Rod:
        for key in ("tip", "self_contact"):
            if getattr(self, key) is not None and self.skin is None:
                raise field_error("is given without a skin, through which the rod touches", key)
        if self.friction > 0.0 and self.skin is None:
            raise field_error("is given without a skin, through which the rod touches", "friction")
        if self.tip is not None and self.tip > self.length:
            tail = f"is {describe(getattr(self.tip, 'text', self.tip))}: the rod is shorter"
            raise field_error(tail, path="tip")
        return self

    @model_validator(mode="after")
    def _check_pieces(self) -> Rod:
        """Check that sections follow one another from base to tip."""
        if not isinstance(self.section, tuple):
            if self.section.span is not None:
                raise field_error("is given, but the rod has one section", path="section.span")
            return self
        end = 0.0
        for index, piece in enumerate(self.section):
            path = f"section[{index}].span"
            if piece.span is None:
                raise field_error("is missing: give where the section begins and ends", path=path)
            if piece.span[0] != end or not piece.span[1] > end:
                tail = f"is {list(piece.span)}: it must begin at {end:g} and end after that"
                raise field_error(tail, path=path)
            end = piece.span[1]
            if self.point_at(end) is None:
                tail = f"ends at {end:g}: it must be an element boundary, a multiple of 1/"
                raise field_error(f"{tail}{self.elements}", path=path)
        if end != 1.0:
            raise field_error(f"ends at {end:g}: the last section must end at 1", path=path)
        return self

    @property
    def pieces(self) -> tuple[Section, ...]:
        """The sections from base to tip."""
        return self.section if isinstance(self.section, tuple) else (self.section,)

    def pieces_at(self, points: Array) -> NDArray[np.intp]:
        """Return which of the sections is at X in [0, 1] (n,), the earlier one where two meet."""
        ends = [1.0 if piece.span is None else piece.span[1] for piece in self.pieces]
        return np.searchsorted(ends, points)

    @property
    def points_across(self) -> tuple[int, ...] | None:
        """Points of the quadrature across the wall of each section, as in the file.

        Copies of the rod with other walls, which are its designs, keep them: their fibres are
        those of the file in other places. None until `fix_points_across`.
        """
        return self._points_across

    def fix_points_across(self, points: tuple[int, ...]) -> None:
        """Fix these for the rod and its copies."""
        self._points_across = points

    @model_validator(mode="after")
    def _check_quadrature(self) -> Rod:
        """Check that the quadrature resolves every function of the basis."""
        for mode, chosen in self.strain.modes.items():
            degree = ELEMENT_DEGREE.get(chosen.basis)
            if degree is not None and self.gauss_points < degree + 1:
                raise field_error(
                    f'is {self.gauss_points}: the basis "{chosen.basis}" of {mode} needs at least '
                    f"{degree + 1} per element",
                    path="gauss_points",
                )
            points = self.elements * self.gauss_points
            if chosen.order is not None and points < chosen.order + 1:
                raise field_error(
                    f"is {self.gauss_points}: with {_count(self.elements, 'element')}, the basis "
                    f'"{chosen.basis}" of order {chosen.order} of {mode} needs at least '
                    f"{-(-(chosen.order + 1) // self.elements)} per element",
                    path="gauss_points",
                )
        return self

    @property
    def shear_modulus(self) -> float:
        """Shear modulus of the isotropic material [Pa]."""
        if self.young_modulus is None or self.poisson_ratio is None:
            raise ValueError("the rod has no material of its own")
        return self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))

    @property
    def last_intervals(self) -> int:
        """Number of intervals into which the last element is divided for quadrature."""
        if self.tip_intervals is not None:
            return self.tip_intervals
        # The tip presses with a few millimetres of its skin.
        return 1 if self.skin is None else TIP_INTERVALS

    @property
    def sample_points(self) -> Array:
        """Sample points X in [0, 1], ends and Gauss points of intervals; shape (P,)."""
        return _sample_points(self.elements, self.gauss_points, self.last_intervals)

    @cached_property
    def surface(self) -> SampledSurface:
        """The surface at the sample points."""
        return SampledSurface(*surface(self.radius, self.sample_points))

    @property
    def sample_count(self) -> int:
        """Number of sample points: ends and Gauss points of intervals."""
        return len(self.sample_points)

    @property
    def gauss_rule(self) -> tuple[NDArray[np.intp], Array]:
        """Which sample points are Gauss points, and their shares of the length, each (G,)."""
        return _gauss_rule(self.elements, self.gauss_points, self.last_intervals)

    @property
    def interval_counts(self) -> NDArray[np.intp]:
        """How many intervals of the length of each make up the rod, from the base; (n,)."""
        return _interval_counts(self.elements, self.last_intervals)

    def point_at(self, fraction: float) -> int | None:
        """Return the sample point at a fraction of the length, if it is an element boundary."""
        end = round(fraction * self.elements)
        if abs(fraction * self.elements - end) > 1e-9:
            return None
        intervals = end if end < self.elements else end - 1 + self.last_intervals
        return intervals * (self.gauss_points + 1)


class Link(Table):
    """A rigid body: a conical frustum along x."""

    kind: Literal["link"]
    parent: Name | None = None
    placement: Placement = Placement()
    joint: Joint = FixedJoint(kind="fixed")
    length: PositiveLength
    radius: LinkRadius
    skin: Skin | None = None
    density: Density = units.DENSITY.si(0.0)

    @model_validator(mode="after")
    def _check_placement(self) -> Link:
        if self.placement.reference != "axis":
            raise field_error('is "underside": only rods support it', path="placement.reference")
        return self


@lru_cache(maxsize=64)
def _sample_points(elements: int, gauss_points: int, tip_intervals: int) -> Array:
    points = _engine.sample_points(elements, gauss_points, tip_intervals)
    points.setflags(write=False)
    return points


def _interval_counts(elements: int, tip_intervals: int) -> NDArray[np.intp]:
    return np.repeat([elements, elements * tip_intervals], [elements - 1, tip_intervals])


@lru_cache(maxsize=64)
def _gauss_rule(
    elements: int, gauss_points: int, tip_intervals: int
) -> tuple[NDArray[np.intp], Array]:
    weights = 0.5 * np.polynomial.legendre.leggauss(gauss_points)[1]
    counts = _interval_counts(elements, tip_intervals)
    points = np.arange(len(counts) * (gauss_points + 1) + 1)
    rule = np.flatnonzero(points % (gauss_points + 1)), (weights / counts[:, None]).ravel()
    for array in rule:
        array.setflags(write=False)
    return rule


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


Body = Annotated[Rod | Link, Field(discriminator="kind"), BeforeValidator(one_of("rod", "link"))]
