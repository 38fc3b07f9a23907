"""Chains slip off stiff obstacles at the same load with any number of steps."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar, root

from flexor.model import Model, parse

LENGTH, RADIUS, BALL, STIFFNESSES = 0.05, 0.0015, 0.0022, (0.035, 0.0006)
PULL = np.array([-0.93, -0.36])
CHAIN = """
name = "chain"
planar = true
[bodies.upper]
kind = "link"
length = "{length} m"
radius = "{radius} m"
joint = {{ kind = "revolute", stiffness = "{stiffnesses[0]} N*m/rad" }}
[bodies.lower]
kind = "link"
parent = "upper"
length = "{length} m"
radius = "{radius} m"
joint = {{ kind = "revolute", stiffness = "{stiffnesses[1]} N*m/rad" }}
[spheres.tip]
points = [{{ body = "lower", at = "tip" }}]
[obstacles.ball]
kind = "sphere"
spheres = ["tip"]
radius = "{ball} m"
stiffness = "{stiffness} N/m"
point = {{ x = "{centre[0]} m", z = "{centre[1]} m" }}
[wrenches.pull]
body = "lower"
at = "tip"
force = {{ x = "{pull[0]} N", z = "{pull[1]} N" }}
input = true
"""


def chain(centre: tuple[float, float], stiffness: float) -> Model:
    text = CHAIN.format(
        length=LENGTH,
        radius=RADIUS,
        ball=BALL,
        stiffnesses=STIFFNESSES,
        pull=PULL,
        centre=centre,
        stiffness=stiffness,
    )
    return Model(parse(text))


def load_on_a_rigid_ball(centre: tuple[float, float], angle: float) -> float:
    """Load at which the tip rests without friction at this angle about the middle of the ball."""
    along = np.array([-np.sin(angle), np.cos(angle)])
    x, down = np.array(centre) * [1, -1] + (RADIUS + BALL) * np.array(
        [np.cos(angle), np.sin(angle)]
    )
    second = np.arccos((x * x + down * down) / (2 * LENGTH**2) - 1)
    first = np.arctan2(down, x) - 0.5 * second
    jacobian = np.array(
        [[-down, -LENGTH * np.sin(first + second)], [x, LENGTH * np.cos(first + second)]]
    )
    moments = np.array(STIFFNESSES) * [first, second]
    rates = np.linalg.solve(jacobian, (RADIUS + BALL) * along)
    return float(moments @ rates / ((RADIUS + BALL) * (PULL * [1, -1]) @ along))


def pulled_off(load: float, near: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the equilibrium without contact near some angles."""

    def unbalanced(q: NDArray[np.float64]) -> NDArray[np.float64]:
        turn = np.array([-np.sin([q[0], q[0] + q[1]]), -np.cos([q[0], q[0] + q[1]])])
        second = load * LENGTH * PULL @ turn[:, 1]
        first = second + load * LENGTH * PULL @ turn[:, 0]
        return np.array(STIFFNESSES) * q - [first, second]

    return np.asarray(root(unbalanced, near, tol=1e-13).x)


@pytest.mark.filterwarnings("ignore:obstacle .ball. may have been passed")
@pytest.mark.parametrize("stiffness", [1e7, 1e9])
@pytest.mark.parametrize(
    ("centre", "before"), [((0.08, -0.04), 5.3), ((0.085, -0.035), 5.2), ((0.072, -0.045), 0.1)]
)
def test_a_tip_slips_off_a_stiff_ball_at_the_same_load_with_any_number_of_steps(
    centre: tuple[float, float], before: float, stiffness: float
) -> None:
    # The ball gives way by less than a hundred-thousandth of its radius.
    angles = (before - 0.3, before, before + 0.3)
    largest = minimize_scalar(
        lambda angle: -load_on_a_rigid_ball(centre, angle), bracket=angles, tol=1e-10
    )
    model = chain(centre, stiffness)
    for steps in (1, 3, 30, 300):
        path = model.equilibrium(0.15 * np.arange(1, steps + 1) / steps)
        assert path.converged.all()
        (event,) = path.events
        assert (event.kind, event.loads[0]) == ("snap", pytest.approx(-largest.fun, rel=1e-5))
        np.testing.assert_allclose(path.q[-1], pulled_off(0.15, path.q[-1]), rtol=1e-6)


@pytest.mark.filterwarnings("ignore:obstacle .ball. may have been passed")
@pytest.mark.parametrize(
    "centre",
    [
        (0.01196, -0.03359),
        (0.01375, -0.03516),
        (0.0164, -0.0371),
        (0.02969, -0.04499),
        (0.03394, -0.04675),
        (0.03851, -0.04812),
        (0.04884, -0.05489),
    ],
)
def test_a_tip_that_few_steps_lead_past_a_ball_slips_off_it(centre: tuple[float, float]) -> None:
    """The curved way to the end of a step leads through the ball, the straight line past it."""
    model = chain(centre, 1e8)
    for steps in (1, 3, 30):
        path = model.equilibrium(0.15 * np.arange(1, steps + 1) / steps)
        assert path.converged.all()
        (event,) = path.events
        turned = np.cumsum(event.angles_before)
        tip = LENGTH * np.array([np.cos(turned).sum(), np.sin(turned).sum()])
        angle = np.arctan2(*(tip - np.array(centre) * [1, -1])[::-1])
        largest = minimize_scalar(
            lambda angle: -load_on_a_rigid_ball(centre, angle),
            bounds=(angle - 0.05, angle + 0.05),
            method="bounded",
            options={"xatol": 1e-12},
        )
        assert (event.kind, event.loads[0]) == ("snap", pytest.approx(-largest.fun, rel=1e-5))
        np.testing.assert_allclose(path.q[-1], pulled_off(0.15, path.q[-1]), rtol=1e-6)
