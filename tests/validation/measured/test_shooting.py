"""The composite strips against an integration of the rod equations that shares no code."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation

from .composite_strips import GRAVITY, LENGTH, STATION, displacements, section_stiffness, strip

Array = NDArray[np.float64]
AXIS = np.array([1.0, 0.0, 0.0])


def shoot(beam: int, angle: float, grams: float) -> Array:
    """Return the station's displacement from r' = R v, R' = R k, m' = -r' × n, (3,) [m]."""
    order = [3, 4, 5, 0, 1, 2]
    compliance = np.linalg.inv(section_stiffness(beam)[np.ix_(order, order)])
    clamp = Rotation.from_euler("x", angle, degrees=True).as_matrix().ravel()
    force = np.array([0.0, 0.0, -1e-3 * GRAVITY * grams])

    def slope(_: float, y: Array) -> Array:
        turn, moment = y[3:12].reshape(3, 3), y[12:]
        strain = compliance @ np.concatenate([turn.T @ moment, turn.T @ force])
        along = turn @ (strain[3:] + AXIS)
        spin = np.cross(strain[:3], np.eye(3)).T
        return np.concatenate([along, (turn @ spin).ravel(), -np.cross(along, force)])

    def integrate(moment: Array) -> Array:
        start = np.concatenate([np.zeros(3), clamp, moment])
        ends = (STATION, LENGTH)
        return solve_ivp(slope, (0.0, LENGTH), start, t_eval=ends, rtol=1e-10, atol=1e-12).y

    guess = 0.8 * LENGTH * np.cross(AXIS, force)
    moment = fsolve(lambda m: integrate(m)[12:, -1], guess, xtol=1e-12)
    return (integrate(moment)[:3, 0] - STATION * AXIS) * [-1.0, 1.0, -1.0]


@pytest.mark.parametrize(
    ("beam", "angle", "grams"), [(1, 45, 400.0), (2, 0, 400.0), (2, 45, 300.0), (3, 45, 500.0)]
)
def test_strips_solve_the_rod_equations(beam: int, angle: float, grams: float) -> None:
    found = displacements(strip(beam, angle), np.array([grams]))[0]
    np.testing.assert_allclose(found, shoot(beam, angle, grams), atol=1e-7)
