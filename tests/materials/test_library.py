"""The library that is shipped."""

from __future__ import annotations

import numpy as np
import pytest

from flexor.errors import InputError
from flexor.materials.fit import is_stable
from flexor.materials.library import find, library
from flexor.materials.table import model_table, modulus
from flexor.model.toml import tables

# Slack, and nominal stress at 50 and 150 % of strain from the crosshead [kPa].
TESTED = {
    "dragon-skin-10": (0.0276, 53.0, 190.6),
    "dragon-skin-20": (0.0137, 151.1, 509.2),
    "dragon-skin-30": (0.0093, 213.9, 689.4),
    "ecoflex-00-30": (0.0331, 16.9, 40.1),
    "ecoflex-00-50": (0.0446, 22.8, 59.5),
}


@pytest.mark.parametrize("name", library())
def test_every_material_is_complete(name: str) -> None:
    material = library()[name]
    assert material.name == name
    assert material.title
    assert material.source
    assert 500.0 < material.density < 2000.0
    end = 1.0 if material.stretch_range is None else material.stretch_range[1]
    assert is_stable(material, max(end, 2.0))


@pytest.mark.parametrize(("name", "tested"), TESTED.items())
def test_fitted_constants_give_the_tests(name: str, tested: tuple[float, float, float]) -> None:
    slack, *expected = tested
    stress = find(name).nominal_stress(np.array([1.5, 2.5]) / (1.0 + slack)) / 1e3
    np.testing.assert_allclose(stress, expected, rtol=0.02)


@pytest.mark.parametrize("name", library())
def test_model_table_has_the_constants(name: str) -> None:
    material = library()[name]
    table = tables(model_table(material, "skin"), "table")["materials"]["skin"]
    assert table["kind"] == material.kind
    units = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9}
    for key, value in material.constants.items():
        given = table[key]
        for text, expected in zip(np.ravel(given), np.ravel(value), strict=True):
            number, _, unit = str(text).partition(" ")
            assert float(number) * (units[unit] if unit else 1.0) == pytest.approx(expected, 1e-5)


def test_modulus_texts() -> None:
    assert [modulus(v) for v in (6.5e9, 1.1e5, -109.4, 2e6)] == [
        '"6.5 GPa"',
        '"110 kPa"',
        '"-109.4 Pa"',
        '"2 MPa"',
    ]


def test_unknown_name() -> None:
    with pytest.raises(InputError, match='did you mean "ecoflex-00-30"'):
        find("ecoflex-0030")
