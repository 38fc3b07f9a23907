"""Convergence to the exact solution: with elements, degree of the basis, and Magnus steps."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import flexor
from flexor.model import Model

from .comparison import at_least, compare
from .drawing import SERIES, order, refinement
from .report import Case
from .systems import build, legendre, rod, sample_points
from .test_cantilever import LENGTH, cantilever, elliptic

Array = NDArray[np.float64]
FAMILY = "Convergence"
ALPHA = 2.0  # P L² / EI
ELEMENTS = (4, 8, 16, 32, 64)
# Gauss points, and the orders of the error at the tip and of the largest error of the angle.
NODAL = {
    "nodal_linear": (3, 4.0, 3.0),
    "nodal_quadratic": (3, 4.0, 3.0),
    "nodal_cubic": (4, 4.0, 3.0),
    "hermite": (4, 4.0, 4.0),
}
DEGREES = tuple(range(8))


def _errors(model: Model) -> tuple[float, float]:
    """Distance of the tip over L, and largest error of the angle [rad]."""
    path = model.equilibrium([0.0, ALPHA], tolerance=1e-13)
    positions, slope, _ = elliptic(ALPHA, sample_points(model, "rod"))
    frames = path.frames(-1)["rod"]
    found = np.array([frames[-1, 0, 3], -frames[-1, 2, 3]]) / LENGTH
    angles = np.arctan2(-frames[:, 2, 0], frames[:, 0, 0])
    distance = float(np.linalg.norm(found - positions[-1]))
    return distance, float(np.max(np.abs(angles - slope)))


def _order(sizes: Array, errors: Array) -> float:
    """Return the slope of log(error) over log(size) through the last three."""
    return float(np.polyfit(np.log(sizes[-3:]), np.log(errors[-3:]), 1)[0])


def test_convergence_elements(case: Case) -> None:
    """Mesh convergence.

    The cantilever at PL²/EI = 2 on 4 to 64 elements compared with elliptic integrals. With every
    basis the tip converges with the order of the Magnus steps, 4 or 2; smoother bases have smaller
    errors, and with Hermite elements the angle converges with order 4, too.
    """
    sizes = 1.0 / np.array(ELEMENTS)
    errors = {
        basis: np.array(
            [_errors(cantilever(basis, elements=n, gauss_points=points)) for n in ELEMENTS]
        )
        for basis, (points, _, _) in NODAL.items()
    }
    comparisons = []
    for basis, (_, tip, angle) in NODAL.items():
        found = errors[basis]
        comparisons += [
            at_least(f"{basis}: order of the tip", tip, _order(sizes, found[:, 0]), 0.15),
            at_least(f"{basis}: order of the angle", angle, _order(sizes, found[:, 1]), 0.15),
        ]
    finest = errors["nodal_quadratic"][-1]
    comparisons.append(compare("nodal_quadratic, 64 elements: tip / L", 0.0, finest[0], 1e-10, 1.0))
    for basis, (points, _, _) in NODAL.items():
        models = [
            cantilever(basis, elements=n, gauss_points=points, magnus_order=2) for n in ELEMENTS
        ]
        tips = np.array([_errors(model)[0] for model in models])
        name = f"{basis}, 2nd-order steps: order of the tip"
        comparisons.append(at_least(name, 2.0, _order(sizes, tips), 0.15))
    case.check(
        comparisons,
        lambda figure: _draw_elements(figure, errors),
        "Error of the cantilever over the number of elements: of the tip's position (left) and of "
        "the angle along the rod (right).",
        panels=2,
    )


def _draw_elements(figure: Figure, errors: dict[str, Array]) -> None:
    tip, angle = figure.subplots(1, 2)
    names = {basis: basis.replace("_", " ") for basis in errors}
    refinement(tip, ELEMENTS, {names[basis]: found[:, 0] for basis, found in errors.items()})
    refinement(angle, ELEMENTS, {names[basis]: found[:, 1] for basis, found in errors.items()})
    order(tip, ELEMENTS[:3], 0.4 * errors["hermite"][0, 0], 4, above=False)
    order(angle, ELEMENTS[:3], 3.0 * errors["nodal_linear"][0, 1], 3, above=True)
    order(angle, ELEMENTS[:3], 0.4 * errors["hermite"][0, 1], 4, above=False)
    tip.set_ylabel("error of the tip / L")
    angle.set_ylabel("error of the angle / rad")
    tip.legend(loc="lower left")


def test_convergence_degree(case: Case) -> None:
    """Convergence with the polynomial degree.

    The same with Legendre polynomials along the whole rod: the error decreases geometrically with
    the degree, down to that of 256 Magnus steps.
    """
    models = [cantilever(legendre(d), elements=64, gauss_points=3) for d in DEGREES]
    errors = np.array([_errors(model)[0] for model in models])
    digits = np.log10(errors[0] / errors[6]) / 6.0
    case.check(
        (
            at_least("digits gained per degree up to 6", 1.5, digits, 0.0),
            compare("degree 7: tip / L", 0.0, errors[-1], 1e-10, 1.0),
        ),
        lambda figure: _draw_degree(figure, errors),
        "Error of the tip's position with Legendre polynomials along the whole rod.",
    )


def _draw_degree(figure: Figure, errors: Array) -> None:
    axes = figure.subplots()
    axes.semilogy(DEGREES, errors, "o-", markersize=3.0, color=SERIES[0])
    axes.set(xlabel="degree", ylabel="error of the tip / L")


# Largest relative errors at any load; bending is the sum of the joint angles.
BARS = {"bending": 5e-3, "max_contact_pressure": 2e-2, "tip_force": 2e-2}
FINE = {"exosuit.elements": 160, "exosuit.gauss_points": 3}


def test_convergence_default_mesh(case: Case) -> None:
    """The mesh of the pneumatic finger.

    `examples/pneumatic-finger.toml` as it is, with 20 elements, at 12 to 60 kPa, compared with 160
    elements of 3 Gauss points. At 12 kPa it touches along 3 % of its length.
    """
    coarse, fine = (
        flexor.load("pneumatic-finger", changes=changes).equilibrium("12:60:12 kPa")
        for changes in ({}, FINE)
    )
    ratios = {
        name: (coarse.joint_angles / fine.joint_angles.sum(axis=1)[:, None]).sum(axis=1)
        if name == "bending"
        else getattr(coarse, name) / getattr(fine, name)
        for name in BARS
    }
    case.check(
        [
            compare(f"{name.replace('_', ' ')} over its limit", np.ones(5), ratios[name], bar, 1.0)
            for name, bar in BARS.items()
        ]
    )


MODES = ("twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z")
# Coefficients of 1, X, X², X³ of each mode: L κ, and linear strains.
FIELD = np.array(
    [
        [1.0, -2.0, 0.5, 1.0],
        [2.0, 1.5, -4.0, 2.0],
        [-1.0, 3.0, 1.0, -2.0],
        [0.1, -0.2, 0.1, 0.05],
        [0.05, 0.1, -0.2, 0.1],
        [-0.1, 0.0, 0.15, 0.1],
    ]
)
STEPS = (1, 2, 4, 8, 16, 32)


def _integrated() -> Array:
    """Integrate the strain field along a unit rod by an explicit method of order 8."""

    def rate(x: float, state: Array) -> Array:
        pose = state.reshape(3, 4)
        kx, ky, kz, *forward = FIELD @ x ** np.arange(4) + np.array([0, 0, 0, 1.0, 0, 0])
        turn = np.array([[0.0, -kz, ky], [kz, 0.0, -kx], [-ky, kx, 0.0]])
        return np.asarray(pose[:, :3] @ np.column_stack([turn, forward])).ravel()

    start = np.eye(3, 4).ravel()
    found = solve_ivp(rate, (0.0, 1.0), start, method="DOP853", rtol=1e-13, atol=1e-14)
    return np.asarray(found.y[:, -1]).reshape(3, 4)


def test_convergence_magnus(case: Case) -> None:
    """Convergence of the Magnus steps.

    Tip pose of a rod whose six strains are prescribed cubics, compared with SciPy's `solve_ivp`
    (DOP853, 10⁻¹³), for steps of order 2 and 4.
    """
    wanted = _integrated()
    strain = {mode: {"basis": "monomial", "order": 3} for mode in MODES}
    errors: dict[int, Array] = {}
    for level in (2, 4):
        found = []
        for elements in STEPS:
            body = rod(1.0, 0.01, strain, elements=elements, gauss_points=4, magnus_order=level)
            model = build("rod", {"rod": body}, planar=False)
            frames = model.engine.frames(model.parameters, FIELD.ravel())
            found.append(np.max(np.abs(frames[-1, :3] - wanted)))
        errors[level] = np.array(found)
    sizes = 1.0 / np.array(STEPS)
    case.check(
        (
            at_least("order of 2nd-order steps", 2.0, _order(sizes, errors[2]), 0.1),
            at_least("order of 4th-order steps", 4.0, _order(sizes, errors[4]), 0.1),
            compare("pose of the tip, 4th order, 160 steps", 0.0, errors[4][-1], 1e-9, 1.0),
        ),
        lambda figure: _draw_magnus(figure, errors),
        "Error of the tip's pose of a rod with cubic strains in all six modes, five Magnus steps "
        "per element.",
    )


def _draw_magnus(figure: Figure, errors: dict[int, Array]) -> None:
    axes = figure.subplots()
    refinement(axes, STEPS, {f"steps of order {o}": found for o, found in errors.items()})
    for slope, found in errors.items():
        order(axes, STEPS[2:5], 3.0 * found[2], slope, above=True)
    axes.set_ylabel("error of the tip's pose")
    axes.legend()
