"""Closed form: a cantilever under a tip load at large deflection, by elliptic integrals."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ellipj, ellipk, ellipkm1

from flexor._engine import sample_points
from flexor.model import Model
from flexor.plot.style import shades

from .comparison import compare
from .drawing import dots
from .elliptic import first, second
from .report import Case
from .systems import build, rod, vector

Array = NDArray[np.float64]
FAMILY = "Closed forms"
LENGTH, RADIUS, YOUNG = 0.2, 0.004, 1e6
EI = YOUNG * np.pi / 4.0 * RADIUS**4
ALPHA = np.array([0.0, 0.25, 0.5, 1.0, 2.0, 4.0, 7.0, 10.0])  # P L² / EI
ELEMENTS, POINTS = 64, 3
X = sample_points(ELEMENTS, POINTS)


def elliptic(alpha: float, fractions: Array) -> tuple[Array, Array, Array]:
    """Solve an inextensible cantilever under a dead load across its tip.

    Parameters
    ----------
    alpha
        P L² / EI.
    fractions : (m,) array
        Places s / L.

    Returns
    -------
    positions : (m, 2) array
        x / L, and the deflection in the direction of the load over L.
    slope, curvature : (m,) arrays
        The angle θ against the x axis [rad], and L times its rate along the rod.

    Notes
    -----
    Bisshopp and Drucker (1945). With 2m = 1 + sin θ_tip and 2m sin² φ = 1 + sin θ, the balance of
    moments integrates to √α s/L = F(φ, m) - F(φ₀, m), so that φ is an amplitude of Jacobi's.
    """
    if alpha == 0.0:
        zero = np.zeros_like(fractions)
        return np.stack([fractions, zero], axis=1), zero, zero
    root = np.sqrt(alpha)

    def excess(gap: float) -> float:  # 1 - m, so that large loads keep their digits
        base = np.arcsin(np.sqrt(0.5 / (1.0 - gap)))
        return float(ellipkm1(gap) - first(base, 1.0 - gap)) - float(root)

    m = 1.0 - brentq(excess, 1e-15, 0.5 - 1e-12, xtol=1e-16)
    base = np.arcsin(np.sqrt(0.5 / m))
    start = first(base, m)
    _, cosine, _, phi = ellipj(start + root * fractions, m)
    x = 2.0 * np.sqrt(m / alpha) * (np.cos(base) - cosine)
    down = fractions - 2.0 / root * (second(phi, m) - second(base, m))
    slope = np.arcsin(2.0 * m * np.sin(phi) ** 2 - 1.0)
    return np.stack([x, down], axis=1), slope, 2.0 * np.sqrt(m * alpha) * cosine


def follower(alpha: float, fractions: Array) -> tuple[Array, Array]:
    """Solve an inextensible cantilever under a load that stays across its tip.

    Parameters
    ----------
    alpha
        P L² / EI, up to 4 K(1/2)² = 13.75.
    fractions : (m,) array
        Places s / L.

    Returns
    -------
    positions : (m, 2) array
        x / L, and the deflection in the direction of the load over L.
    slope : (m,) array
        The angle θ against the x axis [rad].

    Notes
    -----
    The angle χ = θ_tip - θ obeys L² χ″ = α cos χ with χ = χ′ = 0 at the tip. With m = 1/2 and
    sin χ = cos² φ this is √α (1 - s/L) = K(m) - F(φ, m).
    """
    if alpha == 0.0:
        return np.stack([fractions, 0.0 * fractions], axis=1), 0.0 * fractions
    root, m = np.sqrt(alpha), 0.5
    every = np.concatenate([[0.0], fractions])
    sine, cosine, _, phi = ellipj(ellipk(m) - root * (1.0 - every), m)
    quarter = np.arcsin(cosine**2)
    behind = np.where(sine >= 0.0, quarter, np.pi - quarter)  # χ
    along = np.sqrt(2.0) / root * (cosine[0] - cosine)  # ∫ cos χ
    across = 2.0 / root * (second(phi, m) - second(phi[0], m)) - every  # ∫ sin χ
    c, s = np.cos(behind[0]), np.sin(behind[0])
    positions = np.stack([c * along + s * across, s * along - c * across], axis=1)
    return positions[1:], behind[0] - behind[1:]


def cantilever(strain: object = "nodal_quadratic", frame: str = "world", **fields: Any) -> Model:
    """Build the inextensible cantilever; its load along -z is counted in units of EI/L²."""
    chosen = {"young_modulus": YOUNG, "elements": ELEMENTS, "gauss_points": POINTS, **fields}
    body = rod(LENGTH, RADIUS, {"bend_y": strain}, **chosen)
    force = vector((0.0, 0.0, -EI / LENGTH**2), "N")
    load = {"body": "rod", "at": "tip", "force": force, "frame": frame, "input": True}
    return build("cantilever", {"rod": body}, wrenches={"load": load})


def test_cantilever(case: Case) -> None:
    """A cantilever at large deflection.

    An inextensible rod, clamped at one end, under a dead load P perpendicular to the undeformed
    axis at the free end, up to PL²/EI = 10. The shape is given by elliptic integrals
    (`bisshopp1945`), evaluated with `scipy.special`. Flexor has 64 quadratic elements.
    """
    _compare(case, "world", [elliptic(alpha, X)[:2] for alpha in ALPHA])


def test_following_load(case: Case) -> None:
    """A cantilever under a follower load.

    The same rod under a load that stays perpendicular to its tip and has no potential. From the
    tip, the angle obeys the equation of a pendulum starting at rest, which elliptic integrals of
    parameter ½ solve.
    """
    _compare(case, "body", [follower(alpha, X) for alpha in ALPHA])


def _compare(case: Case, frame: str, references: list[tuple[Array, Array]]) -> None:
    path = cantilever(frame=frame).equilibrium(ALPHA, tolerance=1e-12)
    poses = np.stack([path.frames(step)["rod"] for step in range(len(path))])
    shape = np.stack([positions for positions, _ in references])
    slope = np.stack([angles for _, angles in references])
    found = np.stack([poses[..., 0, 3], -poses[..., 2, 3]], axis=-1) / LENGTH
    angles = np.unwrap(np.arctan2(-poses[..., 2, 0], poses[..., 0, 0]))
    comparisons = (
        compare("tip x / L", shape[:, -1, 0], found[:, -1, 0], 1e-9, 1.0),
        compare("tip deflection / L", shape[:, -1, 1], found[:, -1, 1], 1e-9, 1.0),
        compare("positions along the rod / L", shape, found, 1e-9, 1.0),
        compare("angle along the rod [rad]", slope, angles, 5e-8, 1.0),
    )
    case.check(
        comparisons,
        lambda figure: _draw(figure, shape, found),
        "The cantilever under PL²/EI from 0 to 10: elliptic integrals (lines) and Flexor (dots).",
    )


def _draw(figure: Figure, shape: Array, found: Array) -> None:
    axes = figure.subplots()
    for alpha, line, values, colour in zip(ALPHA, shape, found, shades(len(ALPHA)), strict=True):
        axes.plot(line[:, 0], -line[:, 1], color=colour, label=f"{alpha:g}")
        dots(axes, values[::16, 0], -values[::16, 1])
    axes.set(xlabel="x / L", ylabel="z / L", aspect="equal")
    axes.legend(title="PL²/EI", loc="center left", bbox_to_anchor=(1.0, 0.5))
