"""Models of variable size: the paper's finger and a spatial rod, refined."""

from __future__ import annotations

from typing import Any

import numpy as np
from _validation import systems

import flexor
from flexor.design import Geometry, parameter_set
from flexor.model import Model

MODES = ("twist_x", "bend_y", "bend_z", "extend_x", "shear_y", "shear_z")
LENGTH, RADII, YOUNG, DENSITY = 0.2, (0.012, 0.008), 2e5, 1000.0
GRAVITY = (1.0, -2.0, -9.0)
TENDON = ((0.004, 0.002), (-0.003, 0.003))  # (y, z) at base and tip [m]


def finger(elements: int) -> Model:
    """The paper's finger and exosuit, with 2 (elements + 1) + 3 degrees of freedom."""
    return flexor.load("finger", "calibrated", {"exosuit.elements": elements})


def spatial_rod(elements: int) -> Model:
    """A rod with all six strains, a tendon and weight, with 6 (elements + 1) coordinates."""
    return tendon_rod(dict.fromkeys(MODES, "nodal_linear"), elements, 3, GRAVITY)


def tendon_rod(
    strain: dict[str, Any], elements: int, gauss_points: int, gravity: tuple[float, float, float]
) -> Model:
    """A tapered rod in space with a tendon along a straight path."""
    (y0, z0), (y1, z1) = TENDON
    path = {
        "y": [systems.si(y0, "m"), systems.si(y1, "m")],
        "z": [systems.si(z0, "m"), systems.si(z1, "m")],
    }
    body = systems.rod(
        *(LENGTH, RADII, strain),
        young_modulus=YOUNG,
        density=systems.si(DENSITY, "kg/m^3"),
        elements=elements,
        gauss_points=gauss_points,
    )
    return systems.build(
        "spatial rod",
        {"rod": body},
        planar=False,
        gravity=gravity,
        actuators={"tendon": {"kind": "cable", "rod": "rod", "path": path}},
        design={
            "rod": "rod",
            "minimum_radius": "5 mm",
            "length_bounds": ["15 cm", "25 cm"],
            "radius_bounds": ["7 mm", "13 mm"],
        },
        evaluation={"force": "5 N", "step": "1 N"},
    )


def random_radii(count: int, seed: int = 0) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Radii of base and tip of random rods, (count, 2) [m]."""
    return np.random.default_rng(seed).uniform((0.010, 0.007), (0.013, 0.010), (count, 2))


def tapered(model: Model, radii: np.ndarray[Any, np.dtype[np.float64]]) -> Geometry:
    """Geometry of straight tapers."""
    base, tip = radii[:, :1], radii[:, 1:]
    return Geometry(
        length=np.full(len(radii), LENGTH),
        radius=base + (tip - base) * model.X,
        slope=(tip - base) + 0.0 * model.X,
    )


def two_designs(model: Model) -> Geometry:
    """Two designs of a model near its own, the same at every size."""
    if model.planar:
        return parameter_set("L", model.design).geometry(np.array([[0.095], [0.105]]), model.X)
    return tapered(model, np.array([[0.012, 0.008], [0.011, 0.009]]))
