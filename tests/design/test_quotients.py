"""Torsion of hollow sections, a quotient of polynomials of their sizes, over wide ranges."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import flexor
from flexor.design import variables
from flexor.design.slot_map import SlotMap
from flexor.model import Model
from flexor.model.reading import check

SECTIONS: dict[str, tuple[dict[str, Any], dict[str, tuple[str, str]]]] = {
    "half-round": (
        {},
        {
            "exosuit.section.wall": ("1 mm", "4 mm"),
            "exosuit.section.layer.thickness": ("0.2 mm", "1.4 mm"),
        },
    ),
    "box": (
        {"kind": "box", "width": "18 mm"},
        {
            "exosuit.section.wall": ("1 mm", "5 mm"),
            "exosuit.section.width": ("14 mm", "22 mm"),
        },
    ),
}


def spatial(section: dict[str, Any]) -> Model:
    """Return the rod of the pneumatic finger alone, in space, with another section."""
    document = flexor.load("pneumatic-finger").file.to_document()
    rod = document["bodies"]["exosuit"]
    rod |= {"radius": "8 mm", "elements": 1, "gauss_points": 3, "skin": None, "tip": None}
    rod["section"] |= section
    rod["strain"] = dict.fromkeys(("bend_y", "extend_x", "twist_x"), "nodal_linear")
    for key in ("straps", "design", "population"):
        document.pop(key)
    rod.pop("skin")
    rod.pop("tip")
    document |= {"planar": False, "bodies": {"exosuit": rod}}
    return flexor.load(check(document))


@pytest.mark.parametrize("kind", SECTIONS)
def test_wide_ranges(kind: str) -> None:
    """Values are those of the changed file and derivatives those of differences of the torsion."""
    section, bounds = SECTIONS[kind]
    model = spatial(section)
    chosen = variables(bounds, model)
    found = chosen._map(model)
    assert isinstance(found, SlotMap) and found.quotients
    column = int(np.flatnonzero(found.indices == model.engine.slots["exosuit.torsion[0]"][0])[0])
    designs = np.random.default_rng(0).uniform(chosen.lower, chosen.upper, (200, 2))
    for design, values in zip(designs[:8], found.values(designs[:8]), strict=True):
        expected = flexor.load(model.file, changes=chosen.changes(design)).parameters
        actual = model.parameters.copy()
        actual[found.indices] = values
        np.testing.assert_allclose(actual, expected, rtol=1e-9, atol=1e-13)
    slopes = found.jacobian(designs)[:, column]
    span = chosen.upper - chosen.lower
    for i, step in enumerate(np.diag(1e-3 * span)):
        ends = [found.values(designs + f * step)[:, column] for f in (-2.0, -1.0, 1.0, 2.0)]
        difference = (ends[0] - 8.0 * ends[1] + 8.0 * ends[2] - ends[3]) / (12.0 * step[i])
        np.testing.assert_allclose(slopes[:, i], difference, rtol=1e-6, atol=1e-8 / span[i])
