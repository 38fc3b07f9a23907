"""The strain modes of a rod and the functions that describe them along it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from flexor.errors import unknown_name
from flexor.model import units
from flexor.model.fault import fault
from flexor.model.schema.table import Choice, Index, Number, PositiveNumber, Table
from flexor.model.units import Curvature

Basis = Literal[
    "nodal_linear",
    "nodal_quadratic",
    "nodal_cubic",
    "hermite",
    "monomial",
    "legendre",
    "chebyshev",
]
ELEMENT_DEGREE = {"nodal_linear": 1, "nodal_quadratic": 2, "nodal_cubic": 3, "hermite": 3}
GLOBAL = ("monomial", "legendre", "chebyshev")
BASES = (*ELEMENT_DEGREE, *GLOBAL)


class ModeBasis(Table):
    """Functions along the rod for one mode.

    ``nodal_*`` and ``hermite`` live on the rod's elements; ``monomial``, ``legendre`` and
    ``chebyshev`` are polynomials along the whole rod and need their degree, the ``order``.
    """

    basis: Annotated[Basis, Choice(*BASES)]
    order: Annotated[Index, Field(le=50)] | None = None

    @model_validator(mode="after")
    def _check(self) -> ModeBasis:
        if self.basis in GLOBAL and self.order is None:
            raise fault(f'is missing: the basis "{self.basis}" needs its degree', path="order")
        if self.basis not in GLOBAL and self.order is not None:
            what = f'the degree of "{self.basis}" is fixed, leave it out'
            raise fault(f"is {self.order}: {what}", path="order")
        return self


def _expand(value: object) -> object:
    if isinstance(value, str):
        if value in GLOBAL:
            raise fault(f'is "{value}": write {{ basis = "{value}", order = 3 }}, with its degree')
        if value not in ELEMENT_DEGREE:
            raise fault(f"has the {unknown_name('basis', value, BASES)}")
        return {"basis": value}
    return value


Mode = Annotated[ModeBasis | None, BeforeValidator(_expand)]


class Strain(Table):
    """The modes in which a rod deforms; a mode left out is rigid.

    Angular modes come first, in the order of the paper's twists.
    """

    twist_x: Mode = None
    bend_y: Mode = None
    bend_z: Mode = None
    extend_x: Mode = None
    shear_y: Mode = None
    shear_z: Mode = None

    @model_validator(mode="after")
    def _check(self) -> Strain:
        if not self.modes:
            raise fault("has no mode: a rod needs at least one of " + ", ".join(MODES))
        return self

    @property
    def modes(self) -> dict[str, ModeBasis]:
        """The modes present, in the order of the twist."""
        every = ((name, getattr(self, name)) for name in MODES)
        return {name: basis for name, basis in every if basis is not None}


MODES = tuple(Strain.model_fields)
PLANAR_MODES = ("bend_y", "extend_x", "shear_z")


class ReferenceStrain(Table):
    """The strain ξ* of the rod at rest (6): a straight, unstretched rod unless given."""

    twist_x: Curvature = units.CURVATURE.si(0.0)
    bend_y: Curvature = units.CURVATURE.si(0.0)
    bend_z: Curvature = units.CURVATURE.si(0.0)
    extend_x: PositiveNumber = 1.0
    shear_y: Number = 0.0
    shear_z: Number = 0.0
