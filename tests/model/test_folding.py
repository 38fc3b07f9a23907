"""Solid rods that are pressed or bent through themselves."""

from __future__ import annotations

import numpy as np
import pytest

from flexor.model import Model, parse
from flexor.model.folding import least_stretches

RADIUS, LENGTH, YOUNG = 0.01, 0.1, 1e6
ROD = f"""
name = "rod"
planar = true

[bodies.rod]
kind = "rod"
length = "{LENGTH} m"
radius = "{RADIUS} m"
young_modulus = "{YOUNG} Pa"
poisson_ratio = 0.5
section = SECTION
strain = {{ bend_y = "nodal_linear", extend_x = "nodal_linear" }}
elements = 40
gauss_points = 2

[wrenches.load]
body = "rod"
at = "tip"
frame = "body"
input = true
LOAD
"""
CIRCULAR = '"circular"'
RECTANGULAR = '{ kind = "rectangular", ratio = 2.0 }'


def loaded(section: str, load: str) -> Model:
    return Model(parse(ROD.replace("SECTION", section).replace("LOAD", load)))


@pytest.mark.parametrize(("section", "area"), [(CIRCULAR, np.pi), (RECTANGULAR, 8.0)])
def test_a_rod_pressed_through_itself(section: str, area: float) -> None:
    """N = E A ε: the stretch is 1 + N/(E A)."""
    stiffness = YOUNG * area * RADIUS**2
    model = loaded(section, 'force = { x = "-1 N" }')
    path = model.equilibrium([0.0, 0.9 * stiffness, 1.1 * stiffness])
    ((name, stretch),) = least_stretches(path)
    assert name == "rod"
    np.testing.assert_allclose(stretch[1], 0.1, rtol=1e-6)
    np.testing.assert_allclose(stretch[2], -0.1, rtol=1e-6)
    (warning,) = path.warnings
    assert f"from {1.1 * stiffness:.4g} N on" in warning and "-0.1" in warning
    assert not model.equilibrium([0.0, 0.9 * stiffness]).warnings


def test_a_rod_bent_through_itself() -> None:
    """M = E I κ: the least stretch is 1 - κ r."""
    stiffness = YOUNG * np.pi * RADIUS**4 / 4.0
    model = loaded(CIRCULAR, 'moment = { y = "1 N*m" }')
    path = model.equilibrium(np.linspace(0.0, 1.2 * stiffness / RADIUS, 7))
    ((_, stretch),) = least_stretches(path)
    curvature = np.linspace(0.0, 1.2, 7)
    # By chords, of 40 elements with three sample points each.
    np.testing.assert_allclose(stretch.min(axis=1), 1.0 - curvature, atol=2e-3)
    (warning,) = path.warnings
    assert '"rod" is pressed or bent through itself' in warning
