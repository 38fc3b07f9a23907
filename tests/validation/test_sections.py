"""Closed forms of single strains: torsion and shear of every kind of section."""

from __future__ import annotations

import numpy as np

from .comparison import compare
from .report import Case
from .systems import Json, build, rod, vector

FAMILY = "Closed forms"
LENGTH, RADIUS, YOUNG, RATIO = 0.1, 0.008, 1e6, 1.7
SHEAR = YOUNG / 3.0
TWIST, SLIDE = 0.01, (3.0, -5.0)  # N m; N along y and z
MODES = ("twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z")


def rectangle(width: float, height: float) -> float:
    """Return the torsion constant of a rectangle by the double sine series of Prandtl's function.

    Notes
    -----
    ∇²ψ = -2 with ψ = 0 on the boundary and J = 2 ∫ψ dA give
    J = 256 a b/π⁶ Σ 1/(m² n² (m²/a² + n²/b²)) over odd m and n.
    """
    m = np.arange(1.0, 2000.0, 2.0)
    n = m[:, None]
    terms = 1.0 / (m * m * n * n * ((m / width) ** 2 + (n / height) ** 2))
    return float(256.0 * width * height / np.pi**6 * terms.sum())


def test_torsion_and_shear(case: Case) -> None:
    """Torsion and shear of every section.

    A moment about the axis twists a rod by ML/GJ, and a transverse force at the tip of a rod that
    can only shear displaces it by FL/GA, without a shear correction factor. J is Saint-Venant's:
    πS⁴/2, πa³b³/(a² + b²), and for the rectangle the double sine series of Prandtl's stress
    function (Flexor sums 20 terms of another series, to 3·10⁻⁸). Sections are 1.7 times as wide as
    high.
    """
    a, b = RATIO * RADIUS, RADIUS
    sections = {
        "circular": ({"kind": "circular"}, np.pi / 2.0 * b**4, np.pi * b * b),
        "elliptic": (
            {"kind": "elliptic", "ratio": RATIO},
            np.pi * a**3 * b**3 / (a * a + b * b),
            np.pi * a * b,
        ),
        "rectangular": (
            {"kind": "rectangular", "ratio": RATIO},
            rectangle(2.0 * a, 2.0 * b),
            4.0 * a * b,
        ),
    }
    comparisons = []
    tip = {"body": "rod", "at": "tip", "input": True}
    for name, (section, torsion, area) in sections.items():
        shape: Json = {"section": section, "elements": 3, "gauss_points": 2, "young_modulus": YOUNG}
        body = rod(LENGTH, RADIUS, dict.fromkeys(MODES, "nodal_linear"), **shape)
        moment = {**tip, "moment": vector((TWIST, 0.0, 0.0), "N*m")}
        twisted = build("rod", {"rod": body}, planar=False, wrenches={"load": moment})
        frames = twisted.equilibrium([0.0, 1.0]).frames(-1)["rod"]
        angle = np.arctan2(frames[-1, 2, 1], frames[-1, 1, 1])

        body = rod(LENGTH, RADIUS, dict.fromkeys(MODES[4:], "nodal_linear"), **shape)
        force = {**tip, "force": vector((0.0, *SLIDE), "N")}
        sheared = build("rod", {"rod": body}, planar=False, wrenches={"load": force})
        shift = sheared.equilibrium([0.0, 1.0]).frames(-1)["rod"][-1, 1:3, 3]
        comparisons += [
            compare(f"{name}: twist [rad]", TWIST * LENGTH / (SHEAR * torsion), angle, 1e-7),
            compare(
                f"{name}: shift y, z [m]", np.array(SLIDE) * LENGTH / (SHEAR * area), shift, 1e-12
            ),
        ]
    case.check(comparisons)


def test_weight_acts_at_the_centroid(case: Case) -> None:
    """A standing rod whose mass is beside its axis.

    The moment of the weight above X about the axis is ρ A g z (L − X), with z the distance of the
    centroid: for small angles the tip turns by ρ A g z L²/(2 EI). Sized so that the weight on the
    deflection itself changes this by some 5e-6 of it.
    """
    stiff, dense = 1e10, 1000.0
    width, height, offset, length = 10e-3, 4e-3, 6e-3, 40e-3
    rectangle = {"shape": "rectangle", "width": f"{width} m", "height": f"{height} m"}
    body = {
        "kind": "rod",
        "length": f"{length} m",
        "radius": "8 mm",
        "section": {
            "kind": "composite",
            "parts": [
                {**rectangle, "material": "plain"},
                {**rectangle, "material": "dense", "z": f"{offset} m"},
            ],
        },
        "strain": {"bend_y": "nodal_linear"},
        "elements": 8,
        "gauss_points": 2,
    }
    materials = {
        "plain": {"kind": "linear", "young_modulus": f"{stiff} Pa"},
        "dense": {"kind": "linear", "young_modulus": "1e-3 Pa", "density": f"{dense} kg/m^3"},
    }
    down = (-9.81, 0.0, 0.0)
    load = {"body": "rod", "at": "tip", "input": True, "moment": {"y": "1 N*m"}}
    wrenches = {"load": load}
    model = build("rod", {"rod": body}, gravity=down, materials=materials, wrenches=wrenches)
    frames = model.equilibrium([0.0]).frames(-1)["rod"]
    angle = np.arctan2(frames[-1, 2, 0], frames[-1, 0, 0])
    weight = -dense * width * height * down[0]
    expected = weight * offset * length**2 / (2.0 * stiff * width * height**3 / 12.0)
    case.check([compare("turn of the tip [rad]", expected, abs(angle), 1e-5)])
