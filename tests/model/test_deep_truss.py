"""A deep truss on two springs: it leaves its axis before it snaps through.

Loads of events are compared to within the smallest sub-step, 1e-3 of the range.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import fsolve

from flexor.model import Model, parse

Array = NDArray[np.float64]
HALF_SPAN, RISE, STIFFNESS = 0.1, 0.4, 1000.0
REST = float(np.hypot(HALF_SPAN, RISE))

TRUSS = """
name = "deep truss"
planar = true
[bodies.rail]
kind = "link"
length = "1 mm"
radius = "1 mm"
joint = {{ kind = "prismatic", axis = "x" }}
placement = {{ z = "{rise} m", x = "-2 mm" }}
[bodies.node]
kind = "link"
parent = "rail"
length = "1 mm"
radius = "1 mm"
joint = {{ kind = "prismatic", axis = "z" }}
[springs.left]
stiffness = "{left} N/m"
rest_length = "{rest!r} m"
first = {{ body = "node", at = "tip" }}
second = {{ world = {{ x = "-{half} m" }} }}
[springs.right]
stiffness = "{right} N/m"
rest_length = "{rest!r} m"
first = {{ body = "node", at = "tip" }}
second = {{ world = {{ x = "{half} m" }} }}
[wrenches.push]
body = "node"
at = "tip"
input = true
force = {{ z = "-1 N" }}
"""


def truss(ratio: float) -> Model:
    """Return the truss; its right spring is stiffer by this ratio."""
    sizes = {"rise": RISE, "rest": REST, "half": HALF_SPAN}
    return Model(parse(TRUSS.format(left=STIFFNESS, right=STIFFNESS * ratio, **sizes)))


def forces_and_tangent(x: float, z: float, ratio: float) -> tuple[Array, Array]:
    """Return the gradient and the Hessian of the springs' energy in the node's place."""
    force, tangent = np.zeros(2), np.zeros((2, 2))
    for k, foot in ((STIFFNESS, -HALF_SPAN), (ratio * STIFFNESS, HALF_SPAN)):
        arm = np.array([x - foot, z])
        length = float(np.hypot(*arm))
        n = arm / length
        force += k * (length - REST) * n
        along = np.outer(n, n)
        tangent += k * (along + (1.0 - REST / length) * (np.eye(2) - along))
    return force, tangent


@pytest.mark.parametrize("steps", [1, 10, 50, 75, 300])
@pytest.mark.parametrize("multiple", [1.23, 10.7])
def test_the_axis_is_left_at_the_branch_point(steps: int, multiple: float) -> None:
    # The sideways stiffness 2 k (1 - l0 / l + l0 a² / l³) vanishes.
    length = max(np.roots([1.0, -REST, 0.0, REST * HALF_SPAN**2]).real)
    z = float(np.sqrt(length**2 - HALF_SPAN**2))
    critical = 2.0 * STIFFNESS * (REST - length) * z / length
    path = truss(1.0).equilibrium(multiple * critical * np.linspace(0.0, 1.0, steps + 1))
    assert path.stable.all()
    (event,) = path.events
    assert event.loads[0] == pytest.approx(critical, rel=1e-3 * multiple)
    assert path.q[-1, 1] < -2.0 * RISE


@pytest.mark.parametrize("steps", [1, 10, 50, 75, 100, 300])
@pytest.mark.parametrize("multiple", [1.23, 10.7])
def test_an_unequal_truss_snaps_at_its_limit_point(steps: int, multiple: float) -> None:
    ratio = 1.001

    def limit_point(unknown: Array) -> list[float]:
        x, z, p = unknown
        force, tangent = forces_and_tangent(x, z, ratio)
        return [force[0], force[1] + p, np.linalg.det(tangent) / STIFFNESS**2]

    *_, critical = fsolve(limit_point, [-0.0193, 0.3709, 53.67], xtol=1e-12)
    path = truss(ratio).equilibrium(multiple * critical * np.linspace(0.0, 1.0, steps + 1))
    assert path.stable.all()
    (event,) = path.events
    assert event.kind == "snap"
    assert event.loads[0] == pytest.approx(critical, rel=1e-3 * multiple)
    assert path.q[-1, 1] < -2.0 * RISE
