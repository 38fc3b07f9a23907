"""Rods cut lengthwise, and the pressure below them."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.plot.lengthwise import CAVITY, bands
from flexor.plot.reading import read_scene
from flexor.plot.scene import HIGHEST, pressure_scale


def cut(name: str, changes: dict[str, object] | None = None) -> dict[str, list[np.ndarray]]:
    """Return the ends of bands by name, (2, m) [m], at five places along a rod."""
    file = flexor.load(name, changes=changes).file
    (rod,) = [body for body in file.bodies.values() if body.kind == "rod"]
    x = np.linspace(0.0, 1.0, 5)
    surface = np.linspace(*(float(end) for end in (rod.radius.base, rod.radius.tip)), 5)
    found: dict[str, list[np.ndarray]] = {}
    for each in bands(rod, file.materials, x, surface):
        found.setdefault(each.name, []).append(np.stack([each.low, each.high]))
    return found


def test_a_half_round_section_has_its_wall_floor_and_layer() -> None:
    """In the thicknesses of the file, from the crown to the flat side, all along."""
    found = cut("pneumatic-finger")
    thick = [high - low for low, high in found["silicone"]]
    assert sorted(float(each[0]) for each in thick) == pytest.approx([2.5e-3 - 0.5e-3, 2e-3])
    (layer,) = found["fabric"]
    (hollow,) = found[CAVITY]
    np.testing.assert_allclose(layer[1] - layer[0], 0.5e-3, atol=1e-12)
    surface = np.linspace(8e-3, 6e-3, 5)
    np.testing.assert_allclose(hollow[1], surface - 2e-3, atol=1e-12)
    np.testing.assert_allclose(hollow[0], -surface + 2.5e-3, atol=1e-12)


def test_a_wall_of_a_design_is_that_of_its_file() -> None:
    """Thicker, the cavity is lower by as much."""
    thin, thick = (
        cut("pneumatic-finger", {"exosuit.section.wall": wall})[CAVITY][0]
        for wall in ("1.5 mm", "3 mm")
    )
    np.testing.assert_allclose(thin[1] - thick[1], 1.5e-3, atol=1e-12)


def test_pressure_is_that_of_the_path() -> None:
    """At the underside, with one scale for all scenes."""
    path = flexor.load("pneumatic-finger").equilibrium()
    scenes = [read_scene(path, step) for step in (2, -1)]
    largest = [float(each.values.max()) for scene in scenes for each in scene.pressures]
    assert largest == pytest.approx([path.max_contact_pressure[i] for i in (2, -1)])
    assert pressure_scale(scenes)[0] == pytest.approx(HIGHEST / max(largest))
    # One arrow for each link that is touched, their sum that of all contacts.
    contacts = path.contact_forces(-1)
    arrows = scenes[-1].contact_arrows
    touched = {path.model.sphere_places[int(sphere)][0] for sphere in contacts.second}
    assert len(arrows) == len(touched)
    total = sum(arrow.force for arrow in arrows)
    np.testing.assert_allclose(total, -contacts.force.sum(axis=0), atol=1e-12)
