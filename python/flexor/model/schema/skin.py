"""Skins: the soft layers through which rods and links touch."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated

from pydantic import BeforeValidator, Field, model_validator

from flexor.model.schema.table import Name, Table
from flexor.model.units import PositiveLength, PositiveModulus
from flexor.model.validation import field_error

if TYPE_CHECKING:
    from flexor.materials import Material

# Modulus over Young's modulus of a layer of a nearly incompressible material under a contact about
# as wide as the layer is thick, within 20 % (docs/method.md).
NEARLY_INCOMPRESSIBLE = 3.0


class Layer(Table):
    """A layer of a skin: its thickness and its modulus M, given or that of a material.

    That of a material, of the file's or of the library, is the smaller of 3 E and of the confined
    modulus E (1 - ν)/((1 + ν)(1 - 2 ν)), at small strain.
    """

    thickness: PositiveLength
    modulus: PositiveModulus | None = None
    material: Name | None = None

    @model_validator(mode="after")
    def _check(self) -> Layer:
        if (self.modulus is None) == (self.material is None):
            raise field_error("has both or neither of modulus and material: give one of them")
        return self

    def compliance(self, materials: Mapping[str, Material]) -> float:
        """Return thickness over modulus [m/Pa]."""
        if self.modulus is not None:
            return float(self.thickness) / float(self.modulus)
        assert self.material is not None
        material = materials[self.material]
        young, nu = material.young_modulus, material.poisson_ratio
        confined = (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)) if nu < 0.5 else math.inf
        return float(self.thickness) / (young * min(confined, NEARLY_INCOMPRESSIBLE))


def _several(value: object) -> object:
    return value if isinstance(value, (list, tuple)) else (value,)


Skin = Annotated[tuple[Layer, ...], Field(min_length=1), BeforeValidator(_several)]


def compliance(skin: tuple[Layer, ...] | None, materials: Mapping[str, Material]) -> float:
    """Return the compliance of the layers of a skin, one on the other [m/Pa]."""
    return sum(layer.compliance(materials) for layer in skin or ())
