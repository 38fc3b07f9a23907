"""Limbs with tendons as parts of a model: placed elsewhere, mirrored and scaled."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import tomli_w

from flexor.model import load

from .postures import REFERENCE, Imported

WHOLE = """
name = "two-hands"
[parts.right]
file = "limb.toml"
placement = { x = "10 cm", y = "-2 cm", rotation = { x = "20 deg", z = "70 deg" } }
[parts.left]
file = "limb.toml"
mirror = true
[parts.small]
file = "limb.toml"
scale = 0.5
"""


def test_lengths_of_parts(tmp_path: Path) -> None:
    limb = Imported.of(REFERENCE / "limb.xml").converted.tables
    limb.pop("gravity")
    (tmp_path / "limb.toml").write_text(tomli_w.dumps(limb), encoding="utf-8")
    (tmp_path / "whole.toml").write_text(WHOLE, encoding="utf-8")
    model, single = load(tmp_path / "whole.toml"), load(tmp_path / "limb.toml")
    at_rest = single.engine.tendon_lengths(single.parameters, np.zeros(single.dof))
    found = model.engine.tendon_lengths(model.parameters, np.zeros(model.dof))
    lengths = dict(zip(model.tendons, found.tolist(), strict=True))
    for name, length in zip(single.tendons, at_rest.tolist(), strict=True):
        for part, scale in (("right", 1.0), ("left", 1.0), ("small", 0.5)):
            assert lengths[f"{part}.{name}"] == pytest.approx(scale * length, rel=1e-12)
    assert "small.extensor" in model.inputs
