"""The published numbers against the shipped models, which were written from the paper alone."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.design import parameter_set
from flexor.paper import published
from flexor.paper.settings import OBJECTIVES, SETS


@pytest.fixture(scope="module")
def finger():
    return flexor.load("finger")


@pytest.mark.parametrize("name", published.TABLE_I)
def test_table_i_is_the_shipped_finger(finger, name: str) -> None:
    printed = published.TABLE_I[name]
    if name == "exosuit":
        space = finger.design
        own = space.length, space.radius_base, space.radius_tip
    else:
        own = tuple(
            float(finger.slot(f"{name}.{what}")[0])
            for what in ("length", "radius_base", "radius_tip")
        )
    assert own == pytest.approx((printed.length, printed.radius_base, printed.radius_tip))
    if printed.joint_stiffness is not None:
        assert finger.slot(f"{name}.joint_stiffness")[0] == pytest.approx(printed.joint_stiffness)


def test_counts_are_the_shipped_fingers(finger) -> None:
    assert finger.dof == published.DEGREES_OF_FREEDOM.value
    assert finger.sphere_groups["exosuit"] == published.EXOSUIT_SPHERES.value
    assert finger.sphere_groups["finger"] == published.FINGER_SPHERES.value
    printed = flexor.load("finger", constants="printed")
    assert printed.slot("exosuit.young_modulus")[0] == published.YOUNG_MODULUS.value


def test_every_set_of_table_iii_is_there_and_inside_its_bounds(finger) -> None:
    assert tuple(published.TABLE_III) == SETS
    for name, optimum in published.TABLE_III.items():
        parameter_set(name, finger.design).check_inside(np.array(optimum.design))


def test_table_iv_has_a_line_for_each_objective(finger) -> None:
    chosen = parameter_set("L+R01", finger.design)
    for name in OBJECTIVES:
        chosen.check_inside(np.array(published.TABLE_IV[name.removesuffix("-printed")].design))


def test_degrees_are_those_of_the_radians() -> None:
    # 1.43 rad is 81.9°, printed as 82°.
    assert round(np.degrees(published.LARGEST_BENDING.value)) == (
        published.LARGEST_BENDING_DEGREES.value
    )


def test_the_papers_searches_took_a_day() -> None:
    # 30 + 96 + 201 + 66 + 77 + 236 + 264 and 203 + 119 + 166 minutes.
    assert published.hours() == pytest.approx(1458 / 60)
