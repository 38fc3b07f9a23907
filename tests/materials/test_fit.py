"""Fits to curves that are known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from flexor.errors import InputError
from flexor.materials import Material
from flexor.materials.fit import LAWS, fit, fit_laws, is_stable, mean_curve
from flexor.materials.tensile import TensileTest

STRETCH = np.linspace(1.0, 3.0, 201)
KNOWN = {
    "neo-hookean": Material("m", "neo-hookean", {"shear_modulus": 5e4}),
    "mooney-rivlin": Material("m", "mooney-rivlin", {"c10": 4e4, "c01": 1e4}),
    "yeoh": Material("m", "yeoh", {"c1": 3e4, "c2": 2e3, "c3": 50.0}),
    "ogden-1": Material("m", "ogden", {"mu": (3e4,), "alpha": (3.1,)}),
    "ogden-2": Material("m", "ogden", {"mu": (2e4, -1e4), "alpha": (3.0, -4.0)}),
}


def test_of(material: Material, slack: float = 0.0, factor: float = 1.0) -> TensileTest:
    stress = factor * material.nominal_stress(STRETCH)
    return TensileTest("specimen", STRETCH * (1.0 + slack), stress)


test_of.__test__ = False  # type: ignore[attr-defined]


@pytest.mark.parametrize("law", LAWS)
def test_constants_are_recovered(law: str) -> None:
    known = KNOWN[law]
    found = fit(mean_curve([test_of(known)]), law)
    assert found is not None
    assert found.stable
    assert found.rms < 2e-3
    assert found.material.young_modulus == pytest.approx(known.young_modulus, rel=0.02)
    if law not in ("ogden-1", "ogden-2"):
        for key, value in known.constants.items():
            assert found.material[key] == pytest.approx(value, rel=0.03, abs=60.0)


@pytest.mark.parametrize("law", ["neo-hookean", "mooney-rivlin", "ogden-1"])
def test_the_law_with_the_fewest_constants_is_chosen(law: str) -> None:
    fits = fit_laws(mean_curve([test_of(KNOWN[law])]))
    assert fits[0].error < 0.4
    assert LAWS[fits[0].law].size <= LAWS[law].size
    assert {found.law for found in fits} == set(LAWS)


def test_slack_is_removed() -> None:
    curve = mean_curve([test_of(KNOWN["yeoh"], slack=0.04)])
    # A test that starts at its slack carries nothing before.
    assert curve.slack == pytest.approx(0.04, abs=2e-3)
    found = fit(curve, "yeoh")
    assert found is not None
    assert found.material.young_modulus == pytest.approx(1.8e5, rel=0.03)


def test_specimens_give_mean_and_scatter() -> None:
    tests = [test_of(KNOWN["neo-hookean"], factor=factor) for factor in (0.8, 1.0, 1.2)]
    curve = mean_curve(tests, (0.1, 1.0))
    assert curve.specimens == 3
    assert curve.stretch[[0, -1]] == pytest.approx([1.1, 2.0])
    np.testing.assert_allclose(
        curve.stress, KNOWN["neo-hookean"].nominal_stress(curve.stretch), rtol=1e-3
    )
    assert np.median(curve.scatter / curve.stress) == pytest.approx(0.2, rel=0.2)
    one = mean_curve(tests[:1], (0.1, 1.0))
    assert np.all(one.scatter < curve.scatter)


def test_an_unstable_law_is_not_preferred() -> None:
    falling = Material("m", "yeoh", {"c1": 5e4, "c2": -8e3})
    assert not is_stable(falling, 3.0)
    assert is_stable(KNOWN["yeoh"], 3.0)
    assert is_stable(Material("m", "linear", {"young_modulus": 1.0}), 3.0)
    rising = falling.nominal_stress(STRETCH)
    end = int(np.argmax(rising)) + 1
    fits = fit_laws(mean_curve([TensileTest("s", STRETCH[:end], rising[:end])]))
    assert fits[0].stable


def test_errors() -> None:
    with pytest.raises(InputError, match="no tensile tests"):
        mean_curve([])
    with pytest.raises(InputError, match="no common strains"):
        mean_curve([test_of(KNOWN["yeoh"])], (4.0, 5.0))
    with pytest.raises(InputError, match="unknown law"):
        fit(mean_curve([test_of(KNOWN["yeoh"])]), "gent")


def test_deterministic() -> None:
    curve = mean_curve([test_of(KNOWN["ogden-2"])])
    first, second = (fit_laws(curve)[0] for _ in range(2))
    assert first.material.constants == second.material.constants
    assert math.isfinite(first.error)
