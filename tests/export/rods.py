"""Rods to be made."""

from __future__ import annotations

from typing import Any

import tomli_w

from flexor.export import Device, device_of
from flexor.model import Model, parse


def device(section: Any, **more: Any) -> Device:
    rod = {
        "kind": "rod",
        "length": "100 mm",
        "radius": "8 mm",
        "material": "silicone",
        "section": section,
        "strain": {"bend_y": "nodal_linear", "extend_x": "nodal_linear"},
        "elements": 10,
        "gauss_points": 2,
        **more.pop("rod", {}),
    }
    content = {
        "name": "rod",
        "materials": {
            "silicone": {"library": "dragon-skin-30", "winding": "hoop"},
            "fabric": {"kind": "linear", "young_modulus": "20 MPa"},
        },
        "bodies": {"rod": rod},
        **more,
    }
    return device_of(Model(parse(tomli_w.dumps(content))))


def air(*span: float) -> dict[str, Any]:
    return {"kind": "pressure", "rod": "rod", "span": list(span or (0.0, 1.0))}


TUBE = {"kind": "tube", "wall": "2 mm"}
HALF = {"kind": "half-round", "wall": "2 mm", "floor": "2.5 mm"}
