"""The published numbers against the shipped models, which were written from the paper alone."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.design import parameter_set
from reproduction.study import OBJECTIVES, PUBLISHED, SETS, published_design


@pytest.fixture(scope="module")
def finger():
    return flexor.load("finger")


@pytest.mark.parametrize("name", PUBLISHED["bodies"])
def test_table_i_is_the_shipped_finger(finger, name: str) -> None:
    printed = PUBLISHED["bodies"][name]
    if name == "exosuit":
        space = finger.design
        own = [space.length, space.radius_base, space.radius_tip]
    else:
        slots = ("length", "radius_base", "radius_tip")
        own = [float(finger.slot(f"{name}.{slot}")[0]) for slot in slots]
    assert np.multiply(own, 100.0) == pytest.approx([printed["length"], *printed["radius"]])
    if "stiffness" in printed:
        assert finger.slot(f"{name}.joint_stiffness")[0] == pytest.approx(printed["stiffness"])


def test_counts_are_the_shipped_fingers(finger) -> None:
    printed = PUBLISHED["model"]
    assert finger.dof == printed["dof"]
    assert finger.sphere_groups["exosuit"] == printed["exosuit_spheres"]
    assert finger.sphere_groups["finger"] == printed["finger_spheres"]
    literal = flexor.load("finger", constants="printed")
    assert literal.slot("exosuit.young_modulus")[0] == printed["young_modulus"]


def test_surface_is_fitted_to_two_angles_with_the_chamber_on_the_surface() -> None:
    for preset, key in (("finger", "three_links"), ("finger-2-links", "two_links")):
        model = flexor.load(preset, "surface")
        assert model.slot("chamber.lever").tolist() == [0.0, 1.0]
        angle = model.equilibrium("0:10:2").joint_angles[-1].sum()
        assert angle == pytest.approx(PUBLISHED["angles"][key], abs=2e-5)


def test_every_published_optimum_is_inside_the_bounds(finger) -> None:
    for name in SETS:
        parameter_set(name, finger.design).check_inside(published_design(name))
    for objective in OBJECTIVES:
        parameter_set("L+R01", finger.design).check_inside(published_design("L+R01", objective))


def test_degrees_are_those_of_the_radians() -> None:
    # 1.43 rad is 81.9°, printed as 82°.
    angles = PUBLISHED["angles"]
    assert round(np.degrees(angles["optimum"])) == angles["optimum_degrees"]
