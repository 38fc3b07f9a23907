"""Strain modes of a rod and their basis functions."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from flexor.errors import unknown_name
from flexor.model import units
from flexor.model.schema.table import Choice, Index, Number, PositiveNumber, Table
from flexor.model.units import Curvature
from flexor.model.validation import field_error

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
# The condition number of their Gram matrix passes 1e14 here.
MAX_MONOMIAL = 10
BASES = (*ELEMENT_DEGREE, *GLOBAL)


class ModeBasis(Table):
    """Basis functions of one strain mode.

    ``nodal_*`` and ``hermite`` are piecewise polynomials on the rod's elements; ``monomial``,
    ``legendre`` and ``chebyshev`` are polynomials along the whole rod of degree ``order``.
    """

    basis: Annotated[Basis, Choice(*BASES)]
    order: Annotated[Index, Field(le=50)] | None = None

    @model_validator(mode="after")
    def _check(self) -> ModeBasis:
        if self.basis in GLOBAL and self.order is None:
            raise field_error(
                f'is missing: the basis "{self.basis}" needs its degree', path="order"
            )
        if self.basis not in GLOBAL and self.order is not None:
            tail = f'is {self.order}: the degree of "{self.basis}" is fixed, leave it out'
            raise field_error(tail, path="order")
        if self.basis == "monomial" and self.order is not None and self.order > MAX_MONOMIAL:
            tail = f"is {self.order}: monomials above {MAX_MONOMIAL} are numerically dependent, "
            raise field_error(f'{tail}use the basis "legendre" for the same functions', "order")
        return self

    def size(self, elements: int) -> int:
        """Return the number of its functions on a rod of so many elements."""
        if self.order is not None:
            return self.order + 1
        return (
            2 * (elements + 1)
            if self.basis == "hermite"
            else ELEMENT_DEGREE[self.basis] * elements + 1
        )


def _expand(value: object) -> object:
    if isinstance(value, str):
        if value in GLOBAL:
            example = f'{{ basis = "{value}", order = 3 }}'
            raise field_error(f'is "{value}": give its degree, as in {example}')
        if value not in ELEMENT_DEGREE:
            raise field_error(f"has an {unknown_name('basis', value, BASES)}")
        return {"basis": value}
    return value


Mode = Annotated[ModeBasis | None, BeforeValidator(_expand)]


class Strain(Table):
    """Strain modes of a rod; modes that are left out are rigid.

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
            raise field_error("has no mode: a rod needs at least one of " + ", ".join(MODES))
        return self

    @property
    def modes(self) -> dict[str, ModeBasis]:
        """The active modes, in the order of the twist."""
        every = ((name, getattr(self, name)) for name in MODES)
        return {name: basis for name, basis in every if basis is not None}


MODES = tuple(Strain.model_fields)
PLANAR_MODES = ("bend_y", "extend_x", "shear_z")


class ReferenceStrain(Table):
    """The reference strain ξ* (6); by default that of a straight, unstretched rod."""

    twist_x: Curvature = units.CURVATURE.si(0.0)
    bend_y: Curvature = units.CURVATURE.si(0.0)
    bend_z: Curvature = units.CURVATURE.si(0.0)
    extend_x: PositiveNumber = 1.0
    shear_y: Number = 0.0
    shear_z: Number = 0.0
