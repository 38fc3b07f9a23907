"""Energies against closed forms and differences."""

from __future__ import annotations

import math

import numpy as np
import pytest

from flexor.errors import InputError
from flexor.materials import Material

X = np.array([0.3, 0.6, 0.9, 1.0, 1.1, 1.5, 2.4, 6.0])
MU = 0.314e6
MATERIALS = [
    Material("hooke", "linear", {"young_modulus": 2e6, "poisson_ratio": 0.3}),
    Material("rubber", "neo-hookean", {"shear_modulus": MU}),
    Material("mooney", "mooney-rivlin", {"c10": 0.1e6, "c01": 0.03e6}),
    Material("yeoh", "yeoh", {"c1": 0.1e6, "c2": -1e3, "c3": 40.0}),
    Material("ogden", "ogden", {"mu": (0.02e6, -0.01e6), "alpha": (4.2, -1.7)}),
]


def close(found: np.ndarray, expected: np.ndarray, scale: np.ndarray, tolerance: float) -> None:
    np.testing.assert_allclose(found / scale, expected / scale, atol=tolerance)


def wound(material: Material) -> Material:
    return Material(material.name, material.kind, material.constants, winding="hoop")


@pytest.mark.parametrize("material", MATERIALS + [wound(m) for m in MATERIALS])
def test_derivatives(material: Material) -> None:
    h = 1e-5
    up, down, here = (material.energy(X + step) for step in (h, -h, 0.0))
    scale = np.abs(here.second)
    close((up.value - down.value) / (2 * h), here.first, scale, 1e-7)
    close((up.first - down.first) / (2 * h), here.second, scale, 1e-6)
    rest = material.energy(1.0)
    assert rest.value == rest.first == 0.0
    plane = 1.0 - material.poisson_ratio**2 if material.winding == "hoop" else 1.0
    assert rest.second == pytest.approx(material.young_modulus / plane, rel=1e-13)


def test_closed_forms() -> None:
    rubber, mooney, yeoh, ogden = MATERIALS[1:]
    np.testing.assert_allclose(rubber.nominal_stress(X), MU * (X - X**-2), rtol=1e-12)
    np.testing.assert_allclose(wound(rubber).nominal_stress(X), MU * (X - X**-3), rtol=1e-12)
    np.testing.assert_allclose(
        mooney.true_stress(X), 2 * (X**2 - 1 / X) * (0.1e6 + 0.03e6 / X), rtol=1e-12, atol=1e-9
    )
    first = X**2 + 2 / X - 3
    slope = 0.1e6 - 2e3 * first + 120.0 * first**2
    np.testing.assert_allclose(yeoh.nominal_stress(X), 2 * slope * (X - X**-2), atol=1e-6)
    stress = 0.02e6 * (X**3.2 - X**-3.1) - 0.01e6 * (X**-2.7 - X**-0.15)
    np.testing.assert_allclose(ogden.nominal_stress(X), stress, rtol=1e-12, atol=1e-9)


def test_moduli_at_rest() -> None:
    hooke, rubber, mooney, yeoh, ogden = MATERIALS
    assert hooke.shear_modulus == pytest.approx(2e6 / 2.6)
    assert rubber.shear_modulus == pytest.approx(MU)
    assert mooney.shear_modulus == pytest.approx(2 * 0.13e6)
    assert yeoh.young_modulus == pytest.approx(0.6e6)
    assert ogden.shear_modulus == pytest.approx(0.5 * (0.02e6 * 4.2 + 0.01e6 * 1.7))


@pytest.mark.parametrize(
    ("kind", "constants", "words"),
    [
        ("rubber", {}, "unknown kind"),
        ("yeoh", {"c2": 1.0}, "needs c1"),
        ("yeoh", {"c1": -1.0}, "positive"),
        ("yeoh", {"c1": math.nan}, "positive"),
        ("neo-hookean", {"mu": 1.0}, "unknown constant"),
        ("ogden", {"mu": (1.0, 2.0), "alpha": (2.0,)}, "differ in length"),
        ("linear", {"young_modulus": 1.0, "poisson_ratio": 0.6}, "at most 0.5"),
    ],
)
def test_invalid(kind: str, constants: dict[str, float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Material("skin", kind, constants)


def test_invalid_winding() -> None:
    with pytest.raises(InputError, match="unknown winding"):
        Material("skin", "neo-hookean", {"shear_modulus": 1.0}, winding="axial")
