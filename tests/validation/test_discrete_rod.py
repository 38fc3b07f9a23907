"""Another library: a cantilever in space, against PyElastica relaxed to rest."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.typing import NDArray

from flexor.model import Model

from .comparison import compare
from .drawing import SERIES, dots
from .report import Case, load
from .systems import build, rod, si, vector

Array = NDArray[np.float64]
FAMILY = "Other libraries"
LENGTH, RADIUS, YOUNG, DENSITY = 1.0, 0.01, 1e6, 1000.0
AREA = np.pi * RADIUS**2
EI = YOUNG * np.pi / 4.0 * RADIUS**4
FORCE = np.array([0.0, 2.0, -1.0]) * EI / LENGTH**2  # N
GRAVITY = np.array([0.0, 0.0, -3.0]) * EI / (DENSITY * AREA * LENGTH**3)  # m/s²
TIME_STEP, DURATION = 4e-4, 32.0  # s
MODES = ("twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z")


def relaxed(elements: int) -> Array:
    """Positions of PyElastica's nodes at rest, (3, elements + 1) [m].

    Notes
    -----
    PyElastica clamps the first element, whose curvature begins at its middle: the rod is made
    longer by half an element, so that the clamp is at x = 0.
    """
    ea: Any = load("pyelastica", "elastica")
    half = 0.5 * LENGTH / (elements - 0.5)
    parts = (ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Damping)
    simulator = type("Simulator", parts, {})()
    body = ea.CosseratRod.straight_rod(
        elements,
        np.array([-half, 0.0, 0.0]),
        np.array([1.0, 0.0, 0.0]),
        np.array([0.0, 1.0, 0.0]),
        LENGTH + half,
        RADIUS,
        DENSITY,
        youngs_modulus=YOUNG,
        shear_modulus=YOUNG / 3.0,
    )
    # PyElastica corrects the shear stiffness by 27/28; here it is G A.
    for axis in (0, 1):
        body.shear_matrix[axis, axis, :] = YOUNG / 3.0 * AREA
    simulator.append(body)
    ends = {"constrained_position_idx": (0,), "constrained_director_idx": (0,)}
    simulator.constrain(body).using(ea.OneEndFixedBC, **ends)
    simulator.add_forcing_to(body).using(
        ea.EndpointForces, np.zeros(3), FORCE, ramp_up_time=0.2 * DURATION
    )
    simulator.add_forcing_to(body).using(ea.GravityForces, acc_gravity=GRAVITY)
    # Critical damping of the slowest vibration.
    slowest = 1.875**2 * np.sqrt(EI / (DENSITY * AREA * LENGTH**4))
    simulator.dampen(body).using(
        ea.AnalyticalLinearDamper, uniform_damping_constant=2.0 * slowest, time_step=TIME_STEP
    )
    simulator.finalize()
    stepper, time = ea.PositionVerlet(), np.float64(0.0)
    for _ in range(round(DURATION / TIME_STEP)):
        time = stepper.step(simulator, time, np.float64(TIME_STEP))
    return np.asarray(body.position_collection)


def cantilever(basis: str, elements: int) -> Model:
    """Build the same rod; its load is counted in parts of the force."""
    body = rod(
        *(LENGTH, RADIUS, dict.fromkeys(MODES, basis)),
        young_modulus=YOUNG,
        elements=elements,
        gauss_points=3,
        density=si(DENSITY, "kg/m^3"),
    )
    load = {"body": "rod", "at": "tip", "force": vector(FORCE.tolist(), "N"), "input": True}
    return build(
        "cantilever",
        {"rod": body},
        planar=False,
        gravity=GRAVITY.tolist(),
        wrenches={"load": load},
    )


@pytest.mark.slow
def test_relaxed_cantilever(case: Case) -> None:
    """A cantilever by dynamic relaxation.

    A slender rod under its weight and an oblique force at its tip, bent and twisted in space.
    Reference: PyElastica's discrete Cosserat rod with 20 and 40 elements, critically damped until
    it is at rest (32 s in 80,000 steps), with second-order extrapolation. Its cross-sections shrink
    when stretched, unlike Flexor's: with stretches up to 6·10⁻⁵ here, results may differ by 10⁻⁴.
    """
    coarse, fine = relaxed(20), relaxed(40)
    extrapolated = (4.0 * fine[:, -1] - coarse[:, -1]) / 3.0
    path = cantilever("nodal_quadratic", 16).equilibrium([0.0, 0.25, 0.5, 0.75, 1.0])
    shape = path.frames(-1)["rod"][:, :3, 3]
    case.check(
        (compare("tip / L", extrapolated / LENGTH, shape[-1] / LENGTH, 1e-4, 1.0),),
        lambda figure: _draw(figure, fine, shape),
        "The cantilever at rest, from the side and from above: PyElastica with 40 elements (lines) "
        "and Flexor (dots).",
        panels=2,
    )


def _draw(figure: Figure, nodes: Array, shape: Array) -> None:
    panels = figure.subplots(1, 2)
    for axes, axis in zip(panels, (2, 1), strict=True):
        axes.plot(nodes[0, 1:], nodes[axis, 1:], SERIES[0])
        dots(axes, shape[::4, 0], shape[::4, axis])
        axes.set(xlabel="x / L", ylabel=f"{'xyz'[axis]} / L", aspect="equal")
