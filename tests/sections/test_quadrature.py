"""The quadrature of sections by default against a fine one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import tomli_w

from flexor.model import Model, parse
from flexor.sections import across, kinds, shapes

FABRIC = {"kind": "linear", "young_modulus": "30 MPa"}
SILICONES: dict[str, dict[str, Any]] = {
    "ogden": {"library": "dragon-skin-30", "winding": "hoop"},
    "yeoh": {"library": "ecoflex-00-30", "winding": "hoop"},
    "neo-hookean": {"kind": "neo-hookean", "shear_modulus": "0.3 MPa", "winding": "hoop"},
}
LAYER = {"thickness": "0.5 mm", "material": "fabric"}
THIN = {"wall": "2 mm", "floor": "2 mm", "layer": LAYER}
THICK = {"wall": "4 mm", "floor": "3 mm", "layer": LAYER}


def bending(section: dict[str, Any], silicone: str, pressure: float) -> np.ndarray:
    """Angles of the tip [rad] at five pressures."""
    document = {
        "name": "device",
        "planar": True,
        "materials": {"silicone": SILICONES[silicone], "fabric": FABRIC},
        "bodies": {
            "rod": {
                "kind": "rod",
                "length": "120 mm",
                "radius": "7 mm",
                "material": "silicone",
                "section": section,
                "strain": {"bend_y": "nodal_linear", "extend_x": "nodal_linear"},
                "elements": 2,
                "gauss_points": 2,
            }
        },
        "actuators": {"air": {"kind": "pressure", "rod": "rod"}},
    }
    path = Model(parse(tomli_w.dumps(document))).equilibrium(np.linspace(0.0, pressure, 6))
    angles = []
    for step in range(1, 6):
        frames = path.frames(step)["rod"]
        turned = np.unwrap(np.arctan2(frames[:, 0, 2], frames[:, 0, 0]))
        angles.append(turned[-1] - turned[0])
    return np.array(angles)


@pytest.mark.parametrize(
    ("section", "silicone", "pressure"),
    [
        ({"kind": "half-round", **THIN}, "ogden", 140e3),
        ({"kind": "half-round", **THIN}, "yeoh", 6e3),
        ({"kind": "half-round", **THIN}, "neo-hookean", 120e3),
        ({"kind": "half-round", **THICK}, "ogden", 250e3),
        ({"kind": "half-round", **THICK}, "neo-hookean", 250e3),
        ({"kind": "box", "width": "14 mm", **THIN}, "ogden", 140e3),
        ({"kind": "box", "width": "22 mm", **THICK}, "neo-hookean", 250e3),
    ],
)
def test_bending_is_within_half_a_percent(
    section: dict[str, Any], silicone: str, pressure: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    default = bending(section, silicone, pressure)
    assert default[-1] > 1.0
    monkeypatch.setattr(across, "FEWEST", 6)
    monkeypatch.setattr(shapes, "_HALF_ARC", 6)
    monkeypatch.setattr(kinds, "THIN", 6)
    np.testing.assert_allclose(default, bending(section, silicone, pressure), rtol=5e-3)
