"""The modulus of a skin's layer, by plane-strain finite elements."""

from __future__ import annotations

import numpy as np
import pytest

from flexor.materials import Material
from flexor.model.schema.skin import Layer as SkinLayer
from flexor.model.schema.skin import compliance

from .plane_layer import Layer


@pytest.mark.parametrize("nu", [0.3, 0.48, 0.495])
def test_the_modulus_of_a_layer_is_that_of_finite_elements(nu: float) -> None:
    """Within 20 % where the contact is about as wide as the layer is thick."""
    skin = SkinLayer.model_validate({"thickness": "1 m", "material": "tissue"})
    tissue = Material("tissue", "linear", {"young_modulus": 1.0, "poisson_ratio": nu})
    used = 1.0 / compliance((skin,), {"tissue": tissue})
    layer = Layer(nu)
    for half_width in (0.5, 0.7, 1.0):
        found = layer.modulus(10.0, 0.05 * half_width**2)
        assert used == pytest.approx(found, rel=0.2)


def test_a_compressible_layer_ends_as_a_foundation_of_its_confined_modulus() -> None:
    found = Layer(0.3).modulus(10.0, 0.05 * 3.0**2)
    assert found == pytest.approx(0.7 / (1.3 * 0.4), rel=0.01)
    assert np.isclose(Layer(0.3).modulus(20.0, 0.025 * 3.0**2), found, rtol=0.01)
