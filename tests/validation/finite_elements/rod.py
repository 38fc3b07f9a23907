"""The same actuators as rods of Flexor: the chamber's span, and the edge of the last cap."""

from __future__ import annotations

from collections.abc import Sequence
from math import radians

import numpy as np

from flexor.model import Model

from ..systems import Json, build, si
from .actuators import CAP, CONTACT, SHEAR, Actuator
from .sections import Array

MM = 1e-3
LAYER = 1e-5  # m, thickness of a strain-limiting layer, of any material that gives its stiffness
EDGE = 1e-4  # m, radius of the sphere that touches the plane


NAMES = (
    *("half-round", "half-round-blocked", "box-framed", "box-framed-blocked"),
    *("box-framed-wide", "box-framed-high", "box-framed-thick"),
    *("tube-tapered", "tube-tapered-blocked", "tube-stretched", "half-round-bare"),
)
"""Actuators that a rod is compared with."""


def model(actuator: Actuator, elements: int = 20) -> Model:
    """Return the rod of an actuator whose sections keep their outline."""
    height, section = _section(actuator)
    base, tip = MM * height / 2.0, MM * height / 2.0 * actuator.taper
    bodies: dict[str, Json] = {
        "rod": {
            "kind": "rod",
            "length": si(MM * actuator.length, "m"),
            "radius": {"base": si(base, "m"), "tip": si(tip, "m")},
            "material": "silicone",
            "section": section,
            "strain": dict.fromkeys(("bend_y", "extend_x", "shear_z"), "nodal_linear"),
            "elements": elements,
            "gauss_points": 2,
        }
    }
    fabric = 1e3 * actuator.layer_stiffness / LAYER
    tables: dict[str, Json] = {
        "materials": {
            "silicone": {
                "kind": "neo-hookean",
                "shear_modulus": si(1e6 * SHEAR, "Pa"),
                "winding": "none" if actuator.outside == "bare" else "hoop",
            },
            "fabric": {
                "kind": "linear",
                "young_modulus": si(fabric, "Pa"),
            },
        },
        "actuators": {"chamber": {"kind": "pressure", "rod": "rod", "cavity": "bore"}},
    }
    if actuator.plane is not None:
        bodies["cap"] = {
            "kind": "link",
            "parent": "rod",
            "length": si(MM * CAP, "m"),
            "radius": si(EDGE, "m"),
            "placement": {"z": si(EDGE - tip, "m")},
        }
        tables["spheres"] = {"edge": {"points": [{"body": "cap", "at": "tip"}]}}
        tables["obstacles"] = {
            "plane": {
                "kind": "half-space",
                "spheres": ["edge"],
                "point": {"z": si(-base - MM * actuator.plane, "m")},
                "normal": "z",
                # Of the two or three nodes of the finite elements; both halves.
                "stiffness": si(2e3 * CONTACT, "N/m"),
            }
        }
    return build("actuator", bodies, **tables)


def _section(actuator: Actuator) -> tuple[float, Json]:
    """Return the height [mm] of the first section, and its table."""
    layer = {"thickness": si(LAYER, "m"), "material": "fabric"}
    if actuator.kind == "tube":
        bore, wall = actuator.sizes
        table: Json = {"kind": "tube", "wall": wall / (bore + wall)}
        if actuator.layer > 0.0:
            table["layer"] = {**layer, "width": 2.0 * radians(actuator.layer)}
        return 2.0 * (bore + wall), table
    *first, wall, floor = actuator.sizes
    walls = {"wall": si(MM * wall, "m"), "floor": si(MM * floor, "m"), "layer": layer}
    if actuator.kind == "box":
        width = si(MM * (first[0] + 2.0 * wall), "m")
        return first[1] + wall + floor, {"kind": "box", "width": width, **walls}
    return first[0] + wall + floor, {"kind": "half-round", **walls}


def follow(rod: Model, actuator: Actuator, pressures: Sequence[float]) -> dict[str, Array]:
    """Return a rod's states at rising pressures [kPa], in the units of the finite elements.

    `angle`, `tip_x` and `force`, (n,) each.
    """
    path = rod.equilibrium([0.0, *(1e3 * np.asarray(pressures))])
    frames = [path.frames(step) for step in range(len(pressures) + 1)]
    tips = np.array([at["rod"][-1] for at in frames])
    angles = np.degrees(np.unwrap(np.arctan2(tips[:, 0, 2], tips[:, 0, 0])))
    found = {
        "angle": angles[1:],
        "tip_x": (tips[1:, 0, 3] - tips[0, 0, 3]) / MM,
        "force": np.zeros(len(pressures)),
    }
    if actuator.plane is not None:
        edges = np.array([at["cap"][-1] for at in frames[1:]])[:, 2, 3]
        height, _ = _section(actuator)
        depth = EDGE - MM * (height / 2.0 + actuator.plane) - edges
        found["force"] = 2e3 * CONTACT * np.maximum(depth, 0.0)
    return found
