"""Another library: a tendon-driven Cosserat rod in space, against SciPy's solve_bvp."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.typing import NDArray

from flexor.model import Model
from flexor.plot.style import shades

from .boundary_value import Solution, StrongForm
from .comparison import compare
from .drawing import SERIES, dots
from .report import Case
from .states import newton
from .systems import build, rod, sample_points, si, vector

Array = NDArray[np.float64]
FAMILY = "Other libraries"
LENGTH, RADII, YOUNG, DENSITY = 0.25, (0.012, 0.006), 2e5, 1000.0
GRAVITY = np.array([0.0, 0.0, -9.81])
HELIX, TURN = 0.004, 2.0  # m, rad
FORCE, MOMENT = np.array([0.02, 0.03, -0.01]), np.array([0.001, -0.0005, 0.0015])  # N, N m
# Tension [N], and multiples of the tip's force and moment.
LOADS = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.5, 1.0, 0.0), (2.0, 1.0, 1.0)])
MODES = ("twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z")
ELEMENTS = 24


def _strong_form() -> StrongForm:
    shear = YOUNG / 3.0

    def radius(s: Array) -> Array:
        return np.asarray(RADII[0] + (RADII[1] - RADII[0]) * s / LENGTH)

    def stiffness(s: Array) -> Array:
        area, inertia = np.pi * radius(s) ** 2, np.pi / 4.0 * radius(s) ** 4
        bending, sliding = YOUNG * inertia, shear * area
        return np.array([2.0 * shear * inertia, bending, bending, YOUNG * area, sliding, sliding])

    def weight(s: Array) -> Array:
        return np.asarray(DENSITY * np.pi * radius(s) ** 2 * GRAVITY[:, None])

    def cable(s: Array) -> tuple[Array, Array]:
        angle, none, rate = TURN * s / LENGTH, np.zeros_like(s), TURN / LENGTH
        offset = HELIX * np.array([none, np.cos(angle), np.sin(angle)])
        return offset, HELIX * rate * np.array([none, -np.sin(angle), np.cos(angle)])

    return StrongForm(LENGTH, stiffness, weight, cable)


def _model() -> Model:
    strain = dict.fromkeys(MODES, "nodal_quadratic")
    density = si(DENSITY, "kg/m^3")
    shape = {"elements": ELEMENTS, "gauss_points": 3, "density": density}
    body = rod(LENGTH, RADII, strain, young_modulus=YOUNG, **shape)  # type: ignore[arg-type]
    helix = {"radius": si(HELIX, "m"), "turn": si(TURN, "rad")}
    tip = {"body": "rod", "at": "tip", "input": True}
    return build(
        "arm",
        {"rod": body},
        planar=False,
        gravity=GRAVITY.tolist(),
        actuators={"tendon": {"kind": "cable", "rod": "rod", "path": helix}},
        wrenches={
            "force": {**tip, "force": vector(FORCE, "N")},
            "moment": {**tip, "moment": vector(MOMENT, "N*m")},
        },
    )


def _states(model: Model) -> Array:
    """Follow the loads that have a potential; add the moment, which has none, by Newton."""
    dead = LOADS[LOADS[:, 2] == 0.0]
    states = list(model.equilibrium(dict(zip(model.inputs, dead.T, strict=True))).q)
    for fraction in (0.25, 0.5, 0.75, 1.0):
        load = LOADS[-2] + fraction * (LOADS[-1] - LOADS[-2])
        states.append(newton(model, states[-1], load))
    return np.stack([*states[: len(dead)], states[-1]])


@pytest.mark.slow
def test_tendon_arm(case: Case) -> None:
    """A tendon-driven rod in space.

    A tapered rod with all six strains under gravity, a helical tendon, and a force and a moment at
    its tip. Reference: the strong form n′ = −f, m′ = n × r′ with the section law inverted at every
    point, solved by collocation (`scipy.integrate.solve_bvp`, tolerance 10⁻⁸). Flexor has 24
    quadratic elements and follows gravity, tendon and force; the moment, which in space has no
    potential, is added by Newton's method.
    """
    strong = _strong_form()
    solutions: list[Solution] = []
    for tension, force, moment in LOADS:
        near = solutions[-1] if solutions else None
        solutions.append(strong.solve(tension, force * FORCE, moment * MOMENT, near))
    model = _model()
    states = _states(model)
    X = sample_points(model, "rod")
    found = np.stack([model.engine.frames(model.parameters, q)[-len(X) :] for q in states])
    wanted = np.stack([solution.poses(LENGTH * X) for solution in solutions])
    places, theirs = found[..., :3, 3] / LENGTH, wanted[..., :3, 3] / LENGTH
    turns, other = found[..., :3, :3], wanted[..., :3, :3]
    comparisons = (
        compare("tip / L", theirs[:, -1], places[:, -1], 1e-7, 1.0),
        compare("rotation of the tip", other[:, -1], turns[:, -1], 1e-6, 1.0),
        compare("positions along the rod / L", theirs, places, 1e-7, 1.0),
        compare("rotations along the rod", other, turns, 3e-5, 1.0),
    )
    case.check(
        comparisons,
        lambda figure: _draw(figure, solutions, found, states),
        "The rod under all loads from the side and from above, and its curvatures under the last: "
        "collocation (lines) and Flexor (dots).",
        panels=3,
    )


def _draw(figure: Figure, solutions: list[Solution], found: Array, states: Array) -> None:
    side, above, strains = figure.subplots(1, 3)
    X = np.linspace(0.0, 1.0, 200)
    for (tension, *_), solution, frames, colour in zip(
        LOADS, solutions, found, shades(len(LOADS)), strict=True
    ):
        places = 1e2 * solution.poses(LENGTH * X)[:, :3, 3]
        for axes, axis in ((side, 2), (above, 1)):
            axes.plot(places[:, 0], places[:, axis], color=colour, label=f"{tension:g} N")
            dots(axes, 1e2 * frames[::8, 0, 3], 1e2 * frames[::8, axis, 3])
            axes.set(xlabel="x / cm", ylabel=f"{'xyz'[axis]} / cm")
    side.legend(title="tension")
    curvatures = LENGTH * solutions[-1].strains(LENGTH * X)[:3]
    nodes = states[-1].reshape(len(MODES), -1)[:3]
    for line, values, name, colour in zip(curvatures, nodes, "xyz", SERIES, strict=False):
        strains.plot(X, line, color=colour, label=f"L κ$_{name}$")
        dots(strains, np.linspace(0.0, 1.0, len(values))[::4], values[::4])
    strains.set(xlabel="X", ylabel="torsion and bending")
    strains.legend()
