"""Passive torques of joints and couplings, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from flexor.errors import InputError
from flexor.model import Model, parse

HINGE = """
name = "hinge"
planar = true
[bodies.bone]
kind = "link"
length = "5 cm"
radius = "1 cm"
joint = { kind = "revolute", stiffness = "0.01 N*m/rad" }
[bodies.end]
kind = "link"
parent = "bone"
length = "3 cm"
radius = "8 mm"
joint = { kind = "revolute", stiffness = "0.02 N*m/rad" }
[wrenches.moment]
body = "bone"
at = "tip"
moment = { y = "1 N*m" }
input = true
"""


def turned(more: str, moments: list[float]) -> np.ndarray:
    path = Model(parse(HINGE + more)).equilibrium([0.0, *moments])
    assert path.converged.all() and path.stable.all()
    return path.joint_angles[1:]


def test_a_double_exponential() -> None:
    more = """
[torques.passive]
kind = "double-exponential"
body = "bone"
flexion = { moment = "0.02 N*m", rate = 4.0, angle = "50 deg" }
extension = { moment = "0.03 N*m", rate = 6.0, angle = "-10 deg" }
offset = "0.002 N*m"
"""

    def moment(x: float) -> float:
        flexion = 0.02 * np.exp(4.0 * (x - np.radians(50.0)))
        extension = 0.03 * np.exp(-6.0 * (x + np.radians(10.0)))
        return float(flexion - extension + 0.002 + 0.01 * x)

    loads = [0.05, 0.1, -0.1]
    expected = [brentq(lambda x, m=m: moment(x) - m, -3.0, 3.0, xtol=1e-14) for m in loads]
    assert turned(more, loads)[:, 0] == pytest.approx(expected, abs=1e-8)


def test_a_table_is_a_monotone_cubic() -> None:
    angles, torques = (
        np.radians([-20.0, 0.0, 20.0, 60.0, 90.0]),
        np.array([-0.1, 0.0, 0.01, 0.03, 0.2]),
    )
    more = """
[torques.measured]
kind = "table"
body = "bone"
angles = ["-20 deg", "0 deg", "20 deg", "60 deg", "90 deg"]
torques = ["-0.1 N*m", "0 N*m", "0.01 N*m", "0.03 N*m", "0.2 N*m"]
"""
    curve = PchipInterpolator(angles, torques)
    loads = [0.012, 0.04, 0.15, -0.07]
    expected = [
        brentq(lambda x, m=m: float(curve(x)) + 0.01 * x - m, *angles[[0, -1]], xtol=1e-14)
        for m in loads
    ]
    assert turned(more, loads)[:, 0] == pytest.approx(expected, abs=1e-8)
    # Beyond its last angle it goes on with the slope there.
    (found,) = turned(more, [0.5])[:, 0]
    slope = float(curve.derivative()(angles[-1]))
    assert 0.2 + slope * (found - angles[-1]) + 0.01 * found == pytest.approx(0.5, abs=1e-9)


def test_spastic_stiffness_sets_in_at_its_threshold() -> None:
    more = """
[torques.reflex]
kind = "spastic"
body = "bone"
threshold = "30 deg"
stiffness = "0.5 N*m/rad"
width = "5 deg"
resists = "flexion"
"""
    below, above = turned(more, [0.005, 0.1])[:, 0]
    assert below == pytest.approx(0.5, abs=1e-9)  # 0.005 N m on 0.01 N m/rad, 28.6 deg
    start, width = np.radians([30.0, 5.0])
    assert 0.5 * (above - start - 0.5 * width) + 0.01 * above == pytest.approx(0.1, abs=1e-9)


def test_a_coupling_turns_the_second_joint() -> None:
    more = """
[couplings.pip-dip]
first = "bone"
second = "end"
ratio = 0.67
offset = "3 deg"
stiffness = "2 N*m/rad"
"""
    (found,) = turned(more, [0.02])
    matrix = np.array([[0.01 + 2.0 * 0.67**2, -2.0 * 0.67], [-2.0 * 0.67, 0.02 + 2.0]])
    load = np.array([0.02 - 2.0 * 0.67 * np.radians(3.0), 2.0 * np.radians(3.0)])
    assert found == pytest.approx(np.linalg.solve(matrix, load), abs=1e-9)


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        (
            '[torques.t]\nkind = "table"\nbody = "bone"\nangles = ["0 deg", "9 deg", "5 deg"]\n'
            'torques = ["0 N*m", "1 N*m", "2 N*m"]',
            'torques.t.angles[2] is "5 deg": angles must increase',
        ),
        (
            '[torques.t]\nkind = "table"\nbody = "bone"\n'
            'angles = ["0 deg", "9 deg"]\ntorques = ["0 N*m"]',
            "torques.t.torques has too few entries (1)",
        ),
        (
            '[torques.t]\nkind = "spastic"\nbody = "bne"\nthreshold = "3 deg"\n'
            'stiffness = "1 N*m/rad"',
            'torques.t.body refers to the unknown body "bne" (did you mean "bone"?)',
        ),
        (
            '[torques.t]\nkind = "exponential"\nbody = "bone"',
            'torques.t has an unknown kind "exponential" (did you mean "double-exponential"?)',
        ),
        (
            '[couplings.c]\nfirst = "bone"\nsecond = "bone"\nratio = 1.0\nstiffness = "1 N*m/rad"',
            'couplings.c.second is "bone", as first: two joints differ',
        ),
        (
            '[torques.t]\nkind = "spastic"\nbody = "bone"\ncoordinate = "theta_z"\n'
            'threshold = "3 deg"\n'
            'stiffness = "1 N*m/rad"',
            'torques.t.coordinate refers to the unknown angle "theta_z"',
        ),
    ],
)
def test_bad_torques(more: str, expected: str) -> None:
    with pytest.raises(InputError) as error:
        parse(HINGE + more)
    assert expected in str(error.value)
