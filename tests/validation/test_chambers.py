"""Closed forms of rods under a chamber: uniform strain on cylinders, pointwise strain on cones."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.optimize import brentq

from flexor.model import Model
from flexor.plot.style import shades

from .comparison import compare
from .drawing import dots
from .report import Case
from .systems import build, legendre, rod

Array = NDArray[np.float64]
FAMILY = "Closed forms"
LENGTH, RADIUS, YOUNG = 0.1, 0.008, 1e6
FORCES = np.array([0.0, 2.0, 5.0, 10.0])
SPATIAL = ("twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z")
# Area, I_y and I_z over S², S⁴ and S⁴, for half-height S along z and half-width 1.5 S along y.
SECTIONS: dict[str, tuple[float, float, float]] = {
    "circular": (np.pi, np.pi / 4.0, np.pi / 4.0),
    "elliptic": (1.5 * np.pi, 1.5 * np.pi / 4.0, 1.5**3 * np.pi / 4.0),
    "rectangular": (4.0 * 1.5, 4.0 / 3.0 * 1.5, 4.0 / 3.0 * 1.5**3),
}


def _model(strain: Mapping[str, object], lever: dict[str, float], **fields: Any) -> Model:
    radius = fields.pop("radius", RADIUS)
    body = rod(LENGTH, radius, strain, young_modulus=YOUNG, **fields)
    chamber = {"kind": "chamber", "rod": "rod", "lever": lever}
    return build("chamber", {"rod": body}, planar=False, actuators={"chamber": chamber})


def _strain(model: Model, q: Array, mode: str) -> Array:
    """Nodal values of a strain mode: L times a curvature, or a linear strain."""
    names = model.engine.coordinates
    return q[[i for i, name in enumerate(names) if name.startswith(f"rod.{mode}[")]]


def test_extension(case: Case) -> None:
    """A chamber on the axis.

    A chamber along the axis extends a cylinder by ε = u/EA without bending it. Circular, elliptic
    and rectangular sections, all six strains free.
    """
    comparisons = []
    for kind, (area, _, _) in SECTIONS.items():
        section = {"kind": kind} if kind == "circular" else {"kind": kind, "ratio": 1.5}
        nodal = dict.fromkeys(SPATIAL, "nodal_linear")
        model = _model(nodal, {}, section=section, elements=3, gauss_points=2)
        path = model.equilibrium(FORCES)
        wanted = FORCES / (YOUNG * area * RADIUS**2)
        found = np.stack([_strain(model, q, "extend_x") for q in path.q])
        tips = [path.frames(step)["rod"][-1, 0, 3] for step in range(len(path))]
        comparisons += [
            compare(f"{kind}: ε", np.repeat(wanted[:, None], 4, axis=1), found, 1e-12),
            compare(f"{kind}: tip x [m]", LENGTH * (1.0 + wanted), tips, 1e-12),
        ]
    case.check(comparisons)


def test_eccentric_chamber(case: Case) -> None:
    """A chamber off the axis of a cylinder.

    A chamber at (y, z) = (0.4 S, S) gives the uniform strains κ_y = u z/EI_y, κ_z = −u y/EI_z, ε =
    u/EA; the tip's pose is their matrix exponential.
    """
    comparisons = []
    y, z = 0.4, 1.0  # levers, in units of S
    for kind, (area, inertia_y, inertia_z) in SECTIONS.items():
        section = {"kind": kind} if kind == "circular" else {"kind": kind, "ratio": 1.5}
        nodal = dict.fromkeys(("bend_y", "bend_z", "extend_x"), "nodal_linear")
        model = _model(nodal, {"y": y, "z": z}, section=section, elements=3, gauss_points=2)
        path = model.equilibrium(FORCES)
        kappa_y = FORCES * z * RADIUS / (YOUNG * inertia_y * RADIUS**4)
        kappa_z = -FORCES * y * RADIUS / (YOUNG * inertia_z * RADIUS**4)
        epsilon = FORCES / (YOUNG * area * RADIUS**2)
        for mode, wanted, label in (
            ("bend_y", LENGTH * kappa_y, "L κ_y"),
            ("bend_z", LENGTH * kappa_z, "L κ_z"),
            ("extend_x", epsilon, "ε"),
        ):
            found = np.stack([_strain(model, q, mode) for q in path.q])
            comparisons.append(
                compare(f"{kind}: {label}", np.repeat(wanted[:, None], 4, axis=1), found, 1e-11)
            )
        poses = [_screw(ky, kz, e) for ky, kz, e in zip(kappa_y, kappa_z, epsilon, strict=True)]
        found = np.stack([path.frames(step)["rod"][-1] for step in range(len(path))])
        comparisons.append(
            compare(f"{kind}: tip pose (lengths / L)", poses, _over(found), 1e-11, 1.0)
        )
    case.check(comparisons)


def _screw(kappa_y: float, kappa_z: float, epsilon: float) -> Array:
    """Return the tip of a uniformly strained rod, by the matrix exponential; lengths over L."""
    twist = np.zeros((4, 4))
    twist[:3, :3] = [[0.0, -kappa_z, kappa_y], [kappa_z, 0.0, 0.0], [-kappa_y, 0.0, 0.0]]
    twist[0, 3] = (1.0 + epsilon) / LENGTH
    return np.asarray(expm(LENGTH * twist))


def _over(poses: Array) -> Array:
    scaled = poses.copy()
    scaled[..., :3, 3] /= LENGTH
    return scaled


BASE, TIP = 0.012, 0.006
LEVER = 1.5


def test_tapered_chamber(case: Case) -> None:
    """A chamber on the surface of a cone.

    Along a sloping surface at the distance d = 1.5 S(X), only the axial component cos α of the
    chamber's force acts: EI κ = u d cos α, EA ε = u cos α, tan α = d′/(1 + ε + κ d), at each X
    separately (root by bisection). Flexor has Legendre polynomials of degree 14 for both strains.
    """
    strain = {"bend_y": legendre(14), "extend_x": legendre(14)}
    model = _model(strain, {"z": LEVER}, radius=(BASE, TIP), elements=8, gauss_points=8)
    forces = FORCES / 2.0
    path = model.equilibrium(forces)
    X = np.linspace(0.0, 1.0, 41)
    comparisons, wanted, found = [], [], []
    for q, force in zip(path.q, forces, strict=True):
        wanted.append(np.array([_pointwise(x, force) for x in X]))
        series = [_strain(model, q, mode) for mode in ("bend_y", "extend_x")]
        found.append(
            np.stack([np.polynomial.legendre.legval(2 * X - 1, c) for c in series], axis=1)
        )
    for column, label in enumerate(("L κ", "ε")):
        ours, theirs = (np.stack(values)[:, :, column] for values in (found, wanted))
        comparisons.append(compare(f"{label} along the rod", theirs, ours, 1e-8))
    case.check(
        comparisons,
        lambda figure: _draw(figure, X, forces, wanted, found),
        "Curvature and extension of a cone under a chamber on its surface: pointwise closed form "
        "(lines) and Flexor (dots).",
        panels=2,
    )


def _pointwise(x: float, force: float) -> tuple[float, float]:
    """Solve EI κ = u d cos α, EA ε = u cos α, tan α = d′/(1 + ε + κ d) at one X."""
    s = BASE + x * (TIP - BASE)
    d, slope = LEVER * s, LEVER * (TIP - BASE) / LENGTH
    ei, ea = YOUNG * np.pi / 4.0 * s**4, YOUNG * np.pi * s**2

    def mismatch(cosine: float) -> float:
        along = 1.0 + force * cosine * (1.0 / ea + d * d / ei)
        return float(along / np.hypot(along, slope)) - cosine

    cosine = float(brentq(mismatch, 0.5, 1.0, xtol=1e-15))
    return LENGTH * force * cosine * d / ei, force * cosine / ea


def _draw(figure: Figure, X: Array, forces: Array, wanted: list[Any], found: list[Any]) -> None:
    panels = figure.subplots(1, 2)
    for column, (axes, label) in enumerate(zip(panels, ("L κ", "ε"), strict=True)):
        colours = shades(len(forces))
        for force, line, values, colour in zip(forces, wanted, found, colours, strict=True):
            axes.plot(X, line[:, column], color=colour, label=f"{force:g} N")
            dots(axes, X[::4], values[::4, column])
        axes.set(xlabel="X", ylabel=label)
    panels[0].legend()
