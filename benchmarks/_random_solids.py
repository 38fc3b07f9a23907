"""Random designs whose solids are made: the strapped finger, and rods of every kind of section."""

from __future__ import annotations

from typing import Any

import numpy as np
import tomli_w

import flexor
from flexor.export import Device, device_of
from flexor.model import Model, parse

Random = np.random.Generator
FINGER = "pneumatic-finger"
KINDS = (
    *("circular", "elliptic", "rectangular", "tube", "half-round", "box", "composite"),
    *("two sections", "two chambers", "varying"),
)


class Finger:
    """Designs of the strapped finger, within the bounds of its file."""

    def __init__(self) -> None:
        self.model = flexor.load(FINGER)
        assert self.model.file.design is not None
        self.variables = self.model.file.design.variable

    def __call__(self, random: Random) -> Device:
        """Draw a design."""
        from flexor.design import variables

        bounds = {each.field: each.bounds for each in self.variables}
        chosen = variables(bounds, self.model)
        values = random.uniform(chosen.lower, chosen.upper)
        return device_of(flexor.load(self.model.file, changes=chosen.changes(values)))


def rod(kind: str, random: Random) -> Device:
    """Draw a rod with a kind of section."""

    def mm(low: float, high: float) -> str:
        return f"{random.uniform(low, high)} mm"

    base = random.uniform(5.0, 14.0)
    radius: Any = {"base": f"{base} mm", "tip": f"{base * random.uniform(0.6, 1.2)} mm"}
    span = [0.0, 1.0]
    pressures: dict[str, Any] = {"air": {"kind": "pressure", "rod": "rod", "span": span}}
    extra = {"layer": {"thickness": mm(0.2, 0.6), "material": "fabric"}}
    layer = extra if random.integers(2) else {}
    strip = {"layer": {**extra["layer"], "width": mm(2.0, 5.0)}} if layer else {}
    wall = {"wall": mm(1.1, 2.4)}
    half_round = {"kind": "half-round", **wall, "floor": mm(1.1, 2.6), **layer}
    section: Any = {
        "circular": {"kind": "circular"},
        "elliptic": {"kind": "elliptic", "ratio": float(random.uniform(0.5, 2.5))},
        "rectangular": {"kind": "rectangular", "ratio": float(random.uniform(0.5, 2.5))},
        "tube": {"kind": "tube", **wall, **strip},
        "half-round": half_round,
        "varying": {**half_round, "wall": [mm(1.1, 2.4), mm(1.1, 2.4), mm(1.1, 2.4)]},
        "box": {
            "kind": "box",
            "width": mm(12.0, 40.0),
            **wall,
            "floor": mm(1.1, 2.6),
            **layer,
        },
    }.get(kind, half_round)
    if kind in SOLID:
        pressures = {}
    if kind == "varying":
        radius = [f"{base * random.uniform(0.9, 1.3)} mm" for _ in range(4)]
    if kind == "composite":
        section, pressures = composite(random)
    if kind == "two sections":
        cut = int(random.integers(3, 9)) / 12
        stiff = {"kind": "rectangular", "ratio": float(random.uniform(0.8, 2.0))}
        first = [{"span": [0.0, cut], **stiff}, {"span": [cut, 1.0], **half_round}]
        second = [{"span": [0.0, cut], **half_round}, {"span": [cut, 1.0], **stiff}]
        section = first if random.integers(2) else second
    if kind == "two chambers":
        cut = float(random.uniform(0.35, 0.65))
        gap = float(random.choice([0.0, 0.02, 0.15]))
        pressures = {
            "near": {"kind": "pressure", "rod": "rod", "span": [0.0, cut]},
            "far": {"kind": "pressure", "rod": "rod", "span": [cut + gap, 1.0]},
        }
    document = {
        "name": kind.replace(" ", "-"),
        "planar": kind != "composite",
        "materials": {
            "silicone": {"library": "dragon-skin-30"},
            "fabric": {"kind": "linear", "young_modulus": "20 MPa"},
        },
        "bodies": {
            "rod": {
                "kind": "rod",
                "length": mm(60.0, 180.0),
                "radius": radius,
                "material": "silicone",
                "section": section,
                "strain": {"bend_y": "nodal_linear", "extend_x": "nodal_linear"},
                "elements": 12,
                "gauss_points": 2,
            }
        },
        **({"actuators": pressures} if pressures else {}),
    }
    return device_of(Model(parse(tomli_w.dumps(document))))


SOLID = ("circular", "elliptic", "rectangular")


def composite(random: Random) -> tuple[dict[str, Any], dict[str, Any]]:
    """Draw a section of parts: two chambers side by side or above one another, or a ring."""
    form = int(random.integers(3))
    if form == 0:  # a ring, as multiples of S
        wall = float(random.uniform(0.25, 0.4))
        parts = [
            {"shape": "ring", "radius": 1.0, "wall": wall},
            {"shape": "disc", "radius": 1.0 - wall, "cavity": "left"},
        ]
        return (
            {"kind": "composite", "parts": parts},
            {"air": {"kind": "pressure", "rod": "rod", "cavity": "left"}},
        )
    t = float(random.uniform(0.25, 0.4))
    if form == 1:  # two rectangular chambers side by side, on a floor
        width = float(random.uniform(1.6, 2.4))
        room = 0.5 * (2.0 * width - 3.0 * t)
        y = 0.5 * (room + t)
        parts = [
            {"shape": "rectangle", "z": -1.0 + 0.5 * t, "width": 2.0 * width, "height": t},
            {"shape": "rectangle", "z": 1.0 - 0.5 * t, "width": 2.0 * width, "height": t},
        ]
        for place in (-width + 0.5 * t, 0.0, width - 0.5 * t):
            parts.append({"shape": "rectangle", "y": place, "width": t, "height": 2.0 - 2.0 * t})
        for name, place in (("left", y), ("right", -y)):
            hollow = {"width": room, "height": 2.0 - 2.0 * t, "cavity": name}
            parts.append({"shape": "rectangle", "y": place, **hollow})
    else:  # a vault on a slab
        parts = [
            {"shape": "half-ring", "radius": 1.5, "wall": t, "z": -0.5},
            {"shape": "half-disc", "radius": 1.5 - t, "z": -0.5, "cavity": "left"},
            {"shape": "rectangle", "z": -0.75, "width": 3.0, "height": 0.5},
        ]
    names = [part["cavity"] for part in parts if "cavity" in part]
    pressures = {
        f"air-{name}": {"kind": "pressure", "rod": "rod", "cavity": name} for name in names
    }
    return {"kind": "composite", "parts": parts}, pressures
