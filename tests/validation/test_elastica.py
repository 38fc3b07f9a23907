"""Closed form: Euler's column, its buckling loads and what it does beyond them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.optimize import brentq
from scipy.special import ellipj, ellipk

from flexor.model import Model
from flexor.plot.style import shades

from .comparison import Comparison, compare, verdict
from .drawing import SERIES, dots
from .elliptic import second
from .report import Case
from .states import newton, stability
from .systems import build, rod, sample_points, vector

Array = NDArray[np.float64]
FAMILY = "Closed forms"
LENGTH, RADIUS, YOUNG = 0.2, 0.004, 1e6
EULER = 0.25 * np.pi**2 * YOUNG * np.pi / 4.0 * RADIUS**4 / LENGTH**2  # N
TIP_ANGLES = np.radians([20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0, 160.0])
THICK = 0.04


def elastica(tip: float, fractions: Array, waves: int = 1) -> tuple[float, Array, Array]:
    """Solve the inextensible column, clamped at one end, under a dead load along its axis.

    Parameters
    ----------
    tip
        Angle at the free end [rad].
    fractions : (m,) array
        Places s / L.
    waves
        Odd number of quarter waves; 1 is the stable shape.

    Returns
    -------
    load : float
        Over Euler's.
    positions : (m, 2) array
        x / L and deflection / L.
    curvature : (m,) array
        Times L.

    Notes
    -----
    Love, Mathematical Theory of Elasticity, § 263: with k = sin(tip/2) and λ = √(P/EI),
    sin(θ/2) = k sn(λ s) and λ L = waves · K(k).
    """
    m = np.sin(0.5 * tip) ** 2
    reach = waves * ellipk(m)  # λ L
    _, cosine, _, phi = ellipj(reach * fractions, m)
    x = 2.0 * second(phi, m) / reach - fractions
    down = 2.0 * np.sqrt(m) * (1.0 - cosine) / reach
    load = (2.0 * reach / np.pi) ** 2
    return load, np.stack([x, down], axis=1), 2.0 * np.sqrt(m) * reach * cosine


def _column(strain: Mapping[str, object], radius: float = RADIUS, elements: int = 64) -> Model:
    body = rod(LENGTH, radius, strain, young_modulus=YOUNG, elements=elements, gauss_points=3)
    force = vector((-EULER * (radius / RADIUS) ** 4, 0.0, 0.0), "N")
    load = {"body": "rod", "at": "tip", "force": force, "input": True}
    return build("column", {"rod": body}, wrenches={"load": load})


def test_buckling_load(case: Case) -> None:
    """Euler's buckling loads.

    A straight inextensible column, clamped at one end, has the critical loads (2n−1)² P_E with P_E
    = π² EI/4L²: where Flexor's tangent must be singular, and beyond the first of them not positive
    definite. A thick column that shortens and shears buckles where P (1 + P/GA − P/EA) = P_E.
    """
    model = _column({"bend_y": "nodal_quadratic"})
    q = np.zeros(model.dof)
    tangents = [model.engine.tangent(model.parameters, q, np.array([u])) for u in (0.0, 1.0)]
    # The tangent of the straight column is linear in the load: K - P G.
    inverse = eigh(tangents[0] - tangents[1], tangents[0], eigvals_only=True)[::-1]
    comparisons = [
        compare(f"critical load {n} / P_E", (2 * n - 1) ** 2, 1.0 / inverse[n - 1], tolerance)
        for n, tolerance in ((1, 1e-9), (2, 1e-8), (3, 1e-7))
    ]
    for load, expected in ((0.999, "stable"), (1.001, "unstable")):
        found = stability(model, q, np.array([load]))
        comparisons.append(verdict(f"straight column at {load:g} P_E", expected, found))
    comparisons.append(_thick_column())
    case.check(comparisons)


def _thick_column() -> Comparison:
    """Let the column shorten and shear before it buckles."""
    modes = dict.fromkeys(("bend_y", "extend_x", "shear_z"), "nodal_quadratic")
    model = _column(modes, THICK, elements=24)
    # P (1 + P/GA - P/EA) = P_E, with 1/GA = 3/EA; P_E/EA = (π S / 4 L)².
    slenderness = (0.25 * np.pi * THICK / LENGTH) ** 2
    wanted = (np.sqrt(1.0 + 8.0 * slenderness) - 1.0) / (4.0 * slenderness)
    names = model.engine.coordinates
    extension = np.array([name.startswith("rod.extend_x[") for name in names])

    def determinant(load: float) -> float:
        q = np.where(extension, -load * slenderness, 0.0)
        tangent = model.engine.tangent(model.parameters, q, np.array([load]))
        scale = np.sqrt(np.diag(tangent))
        return float(np.linalg.det(tangent / np.outer(scale, scale)))

    found = brentq(determinant, 0.5, 1.2, xtol=1e-13)
    return compare("thick column that shortens and shears, P / P_E", wanted, found, 1e-8)


def test_elastica(case: Case) -> None:
    """The buckled column.

    Beyond P_E the column follows the elastica sin(θ/2) = k sn(s√(P/EI)) with elliptic integrals
    from `scipy.special` (Love, *Mathematical Theory of Elasticity*, § 263). The path from zero load
    must leave the straight state, which becomes unstable, and follow the stable shape. The shape
    with three quarter waves, found by Newton's method, must be reported as unstable.
    """
    model = _column({"bend_y": "nodal_quadratic"})
    X = sample_points(model, "rod")
    solved = [elastica(tip, X) for tip in TIP_ANGLES]
    before = np.array([0.0, 0.5, 0.99])
    loads = np.concatenate([before, [load for load, _, _ in solved]])
    path = model.equilibrium(loads, tolerance=1e-12)
    poses = np.stack([path.frames(step)["rod"] for step in range(len(path))])
    found = np.stack([poses[..., 0, 3], np.abs(poses[..., 2, 3])], axis=-1) / LENGTH
    straight = np.stack([np.stack([X, 0.0 * X], axis=1)] * len(before))
    buckled = np.stack([positions for _, positions, _ in solved])
    comparisons = [
        compare("below P_E: positions / L", straight, found[: len(before)], 1e-9, 1.0),
        compare("beyond P_E: tip x / L", buckled[:, -1, 0], found[3:, -1, 0], 2e-9, 1.0),
        compare("beyond P_E: tip deflection / L", buckled[:, -1, 1], found[3:, -1, 1], 2e-9, 1.0),
        compare("beyond P_E: positions along the rod / L", buckled, found[3:], 2e-9, 1.0),
        verdict("buckled column", "stable", "stable" if path.stable[3:].all() else "unstable"),
    ]
    for load in loads[3::3]:
        found_straight = stability(model, np.zeros(model.dof), np.array([load]))
        name = f"straight column at {load:.3g} P_E"
        comparisons.append(verdict(name, "unstable", found_straight))
    comparisons += _second_shape(model, X)
    case.check(
        comparisons,
        lambda figure: _draw(figure, loads, straight, buckled, found),
        "The column under rising load: the elastica (lines) and Flexor (dots). Right: deflection "
        "of the tip over the load; the straight column (dashed) is unstable beyond Euler's load.",
        panels=2,
    )


def _second_shape(model: Model, X: Array) -> list[Comparison]:
    """Find the elastica of three quarter waves, an equilibrium that no real column keeps."""
    load, wanted, _ = elastica(np.radians(60.0), X, waves=3)
    nodes = np.linspace(0.0, 1.0, model.dof)
    guess = np.radians(60.0) * 1.5 * np.pi * np.cos(1.5 * np.pi * nodes)
    q = newton(model, guess, np.array([load]))
    frames = model.engine.frames(model.parameters, q)[-len(X) :]
    found = np.stack([frames[:, 0, 3], -frames[:, 2, 3]], axis=1) / LENGTH
    name = f"three quarter waves at {load:.3g} P_E"
    return [
        compare(f"{name}: positions / L", wanted, found, 5e-8, 1.0),
        verdict(name, "unstable", stability(model, q, np.array([load]))),
    ]


def _draw(figure: Figure, loads: Array, straight: Array, buckled: Array, found: Array) -> None:
    shape, branch = figure.subplots(1, 2, width_ratios=(3, 2))
    lines = [*straight, *buckled]
    for load, line, values, colour in zip(loads, lines, found, shades(len(loads)), strict=True):
        label = f"{load:.3g}" if load > 1.0 else None
        shape.plot(line[:, 0], line[:, 1], color=colour, label=label)
        dots(shape, values[::16, 0], values[::16, 1])
    shape.set(xlabel="x / L", ylabel="deflection / L", aspect="equal", xlim=(-0.45, 1.45))
    shape.legend(title="P / P$_E$", loc="upper right", labelspacing=0.2)
    end = np.array([1.0])
    dense = [elastica(tip, end) for tip in np.radians(np.linspace(0.5, 165.0, 100))]
    branch.plot([0.0, 1.0], [0.0, 0.0], SERIES[0])
    branch.plot([1.0, loads[-1]], [0.0, 0.0], "--", color=SERIES[0])
    branch.annotate("straight, unstable", (2.5, 0.02), color=SERIES[0], ha="center")
    branch.plot([load for load, _, _ in dense], [p[0, 1] for _, p, _ in dense], SERIES[0])
    dots(branch, loads, found[:, -1, 1])
    branch.set(xlabel="P / P$_E$", ylabel="deflection of the tip / L")
