"""Stiffness of shear of cross-sections: closed forms, layers, and what a design makes of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from flexor import load, sections
from flexor.arrays import Array
from flexor.design import variables
from flexor.model import Model
from flexor.model.schema.strain import MODES
from flexor.sections import Geometry, Linear, Part, Rectangle
from flexor.sections.linear import ZERO

YOUNG, SHEAR = {"rubber": 1.0, "sheet": 1e12}, {"rubber": 1.0 / 3.0, "sheet": 1e12 / 3.0}


def factor(geometry: Geometry, s: float = 1.0) -> Array:
    """Return shear stiffness along y and z by that of all parts in series."""
    found = sections.shear_stiffness(geometry.parts, YOUNG, SHEAR, s)
    return np.array(found) / geometry.shear_in_series(SHEAR, s)


def tube(wall: float) -> Geometry:
    return sections.tube(Linear(wall), "rubber", 1.0, "outside", False)


def test_solid_sections() -> None:
    """5/6 of a rectangle; 27/32 of a disc by stresses that follow its outline (exact: 6/7)."""
    assert factor(sections.solid("rectangular", 1.7, "rubber")) == pytest.approx(5.0 / 6.0)
    assert factor(sections.solid("circular", 1.0, "rubber")) == pytest.approx(27.0 / 32.0)
    wide = factor(sections.solid("elliptic", 2.0, "rubber"))
    assert wide == pytest.approx(factor(sections.solid("elliptic", 0.5, "rubber"))[::-1])
    assert wide[0] > 27.0 / 32.0 > wide[1]


def test_round_tubes() -> None:
    """A thin one has half of its area; others, 2 % from Cowper (1966) with ν = 0."""
    assert factor(tube(1e-3)) == pytest.approx(0.5, rel=1e-4)
    for wall in (0.3, 0.5, 0.8):
        square = (1.0 - wall) ** 2
        cowper = 6.0 * (1.0 + square) ** 2 / (7.0 * (1.0 + square) ** 2 + 20.0 * square)
        assert factor(tube(wall)) == pytest.approx(cowper, rel=0.02)


def test_a_thin_square_tube() -> None:
    """The webs carry nearly all: EI²/∫ S²/(G b) dz by hand, of side a and wall t."""
    a, t = 2.0, 0.001
    box = sections.box(Linear(a), Linear(t), Linear(t), None, "rubber", 1.0, "outside", False)
    inertia = 2.0 * t * a**3 / 12.0 + 2.0 * a * t * (a / 2.0) ** 2
    # S = t a²/2 + t (a²/4 - z²) in the webs of width 2 t; none to speak of in top and floor.
    z = np.linspace(-a / 2.0, a / 2.0, 4001)
    held = t * a**2 / 2.0 + t * (a**2 / 4.0 - z**2)
    compliance = (held**2 / (2.0 * t)).mean() * a
    expected = inertia**2 / compliance / (4.0 * a * t)
    assert factor(box)[1] == pytest.approx(expected, rel=5e-3)


def test_a_stiff_sheet_below_takes_no_part() -> None:
    """S = E b (h² - z²)/2 and EI = E b h³/3 about the sheet give 5/6 G b h, that of the layer."""
    thin, high, wide = 1e-6, 0.8, 1.3
    layer = Part(Rectangle(ZERO, Linear(high / 2.0), Linear(wide), Linear(high)), "rubber")
    sheet = Part(Rectangle(ZERO, Linear(-thin / 2.0), Linear(wide), Linear(thin)), "sheet")
    both = sections.composite([layer, sheet], {}, None)
    found = sections.shear_stiffness(both.parts, YOUNG, SHEAR, 1.0)[1]
    assert found == pytest.approx(5.0 / 6.0 * SHEAR["rubber"] * wide * high, rel=1e-4)
    assert factor(both)[1] == pytest.approx(5.0 / 6.0, rel=1e-4)


def test_edges_that_differ_by_rounding() -> None:
    walls = [
        sections.box(Linear(2.0), Linear(t), Linear(0.2), None, "rubber", 1.0, "outside", True)
        for t in np.linspace(0.1, 0.3, 21)
    ]
    found = np.array([factor(each) for each in walls])
    assert np.isfinite(found).all()
    assert (found > 0.2).all()
    assert (found < 1.0).all()


FILE = """
name = "slide"
planar = {planar}
[materials]
rubber = {{ kind = "neo-hookean", shear_modulus = "{shear} MPa" }}
sheet = {{ kind = "linear", young_modulus = "30 MPa" }}
[bodies.rod]
kind = "rod"
length = "0.1 m"
radius = {{ base = "8 mm", tip = "6 mm" }}
material = "rubber"
section = {section}
strain = {strain}
elements = 3
gauss_points = 2
[wrenches.load]
body = "rod"
at = "tip"
input = true
force = {{ z = "1 N" }}
"""
SLIDING = '{ shear_z = "nodal_linear" }'
ALL = "{ " + ", ".join(f'{mode} = "nodal_linear"' for mode in MODES) + " }"
HALF_ROUND = (
    '{ kind = "half-round", wall = "2 mm", floor = "2 mm", '
    'layer = { thickness = "0.2 mm", material = "sheet" } }'
)


def model(folder: Path, section: str, strain: str, shear: float = 0.3) -> Model:
    file = folder / "slide.toml"
    planar = "false" if strain == ALL else "true"
    file.write_text(FILE.format(section=section, strain=strain, planar=planar, shear=shear))
    return load(file)


def test_a_rod_that_can_only_shear(tmp_path: Path) -> None:
    """∫ F dX/κGA."""
    rod = model(tmp_path, '{ kind = "tube", wall = 0.25 }', SLIDING)
    slides = rod.equilibrium([0.0, 1.0]).frames(-1)["rod"][-1, 2, 3]
    ring = sections.tube(Linear(0.0, 0.25), "rubber", 1.0, "outside", False)
    area = np.pi * (1.0 - 0.75**2)
    flexibility = 0.1 / (8e-3 * 6e-3)  # of ∫ dX/S², S linear
    assert slides == pytest.approx(flexibility / (factor(ring)[1] * 0.3e6 * area), rel=2e-4)


def test_what_a_design_makes_of_it(tmp_path: Path) -> None:
    """Parameters of a design, as of the changed file, and their derivatives by differences."""
    rod = model(tmp_path, HALF_ROUND, ALL)
    fields = {
        "rod.section.wall": ("1.8 mm", "2.2 mm"),
        "rod.section.floor": ("1.8 mm", "2.2 mm"),
        "materials.rubber.shear_modulus": ("0.28 MPa", "0.32 MPa"),
    }
    varied = variables(fields, rod)
    x = varied.lower + np.array([0.3, 0.6, 0.8]) * (varied.upper - varied.lower)
    found, _ = varied.designs(x[None, :], rod)
    shear = rod.engine.slots["rod.shear[0]"]
    own = found.indices.searchsorted(np.arange(*shear))
    changed = load(rod.file, changes=varied.changes(x))
    assert found.values[0, own] == pytest.approx(changed.parameters[slice(*shear)], rel=1e-9)
    slopes = varied.slot_jacobian(x[None, :], rod)[0, own]
    for i, span in enumerate(varied.upper - varied.lower):
        ahead, behind = x.copy(), x.copy()
        ahead[i] += 1e-3 * span
        behind[i] -= 1e-3 * span
        moved = [varied.designs(each[None, :], rod)[0].values[0, own] for each in (ahead, behind)]
        assert (moved[0] - moved[1]) / (2e-3 * span) == pytest.approx(slopes[:, i], rel=1e-5)
