"""A rope over a cylinder that friction alone holds, in its plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import _cosserat_model as rods
import numpy as np
from _validation import systems
from numpy.typing import NDArray

from flexor.model import Path

MODES = ("bend_y", "extend_x", "shear_z")
OVERLAP = 0.02  # of the rope with the cylinder, of its radius, in the mean
SPRING = "1 kN/m"  # that lay the rope on the cylinder, far stiffer than the rope


@dataclass(frozen=True)
class Laid:
    """A rope as it is laid on the cylinder, and its equilibrium with friction.

    Attributes
    ----------
    nodes : (n + 1, 3) array
        Places [m] of the nodes as it is laid.
    path : Path
        The equilibrium that friction holds, if there is one.
    """

    nodes: NDArray[np.float64]
    path: Path


def laid(scenario: Any, n_elements: int, max_seconds: float = float("inf")) -> Laid:
    """Lay a rope on a cylinder as a scenario begins, and let it go.

    A path begins without friction's forces, which need normal forces and elastic slip. So the rope
    is first laid by springs where the scenario has it, but overlapping the cylinder by as much as
    its weight will make it; then these are gone, and friction acts from there.
    """
    (rod,), (cylinder,) = scenario.rods, scenario.obstacles
    own = rods.shape(rod, n_elements)
    middle = np.asarray(cylinder.center, dtype=float)
    reach = cylinder.radius + (1.0 - OVERLAP) * rod.radius
    nodes = own.nodes.copy()
    above = nodes[:, 2] > middle[2]
    radial = nodes[above] - middle
    nodes[above] = middle + reach * radial / np.linalg.norm(radial, axis=1, keepdims=True)
    nodes[~above, 0] = middle[0] + np.sign(nodes[~above, 0] - middle[0]) * reach
    ends = np.arctan2(-own.base[2, 0], own.base[0, 0])
    young, shear = rod.material.youngs_modulus, rod.material.shear_modulus
    body = {
        **systems.rod(
            own.length,
            rod.radius,
            dict.fromkeys(MODES, "nodal_linear"),
            young_modulus=young,
            elements=n_elements,
            gauss_points=rods.GAUSS_POINTS,
        ),
        "poisson_ratio": young / (2.0 * shear) - 1.0,
        "density": systems.si(rod.material.density, "kg/m^3"),
        "joint": {"kind": "free"},
        "placement": {**systems.vector(nodes[0], "m"), "rotation": {"y": systems.si(ends, "rad")}},
    }
    springs = {
        f"node{i}": {
            "first": {"body": "rod", "point": rods.SAMPLES * i},
            "second": {"world": systems.vector(node, "m")},
            "stiffness": SPRING,
        }
        for i, node in enumerate(nodes)
    }
    start = {f"rod.extend_x[{i}]": float(each) - 1.0 for i, each in enumerate(own.stretch)}
    start |= {f"rod.bend_y[{i}]": float(k) for i, k in enumerate(own.curvature[:, 1] * own.length)}
    held = systems.build("laid", {"rod": body}, springs=springs).equilibrium(
        np.zeros((1, 0)), start=start
    )
    post = {
        "kind": "cylinder",
        "axis": "y",
        "radius": systems.si(cylinder.radius, "m"),
        "point": systems.vector(middle, "m"),
        "spheres": ["rod"],
        "stiffness": systems.si(_stiffness(rod, own, scenario.gravity, above, n_elements), "N/m"),
        "friction": cylinder.friction,
    }
    model = systems.build(
        "capstan",
        {"rod": body},
        gravity=scenario.gravity,
        spheres={"rod": {"bodies": ["rod"]}},
        obstacles={"post": post},
    )
    path = model.equilibrium(np.zeros((1, 0)), start=held[-1], max_seconds=max_seconds)
    return Laid(rods.in_plane(held[-1]), path)


def _stiffness(rod: Any, own: rods.Shape, gravity: Any, above: Any, n_elements: int) -> float:
    """Return the stiffness [N/m] of a sphere with which the rope sinks in by the overlap."""
    weight = rod.material.density * np.pi * rod.radius**2 * np.linalg.norm(gravity)
    # The mean of the tensions on both sides presses it on, over its length there.
    hanging = 0.5 * weight * own.length * np.count_nonzero(~above) / len(above)
    spheres = rods.SAMPLES * np.count_nonzero(above)
    return float(np.pi * hanging / (spheres * OVERLAP * rod.radius))
