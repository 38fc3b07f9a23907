"""Contacts that spheres too far apart would miss are warned of, once for each model."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexor
from flexor.cli.app import main
from flexor.errors import ModelWarning

ROD = """
[bodies.{name}]
kind = "rod"
length = "100 mm"
radius = "1 mm"
young_modulus = "1 GPa"
poisson_ratio = 0.3
placement = {{ {place} }}
strain = {{ bend_y = "nodal_quadratic", bend_z = "nodal_quadratic", twist_x = "nodal_linear" }}
elements = 10
gauss_points = 3
[spheres.{name}]
bodies = ["{name}"]
"""
ACROSS = 'x = "83.7 mm", y = "-46.3 mm", rotation = { z = "90 deg" }'
CROSSING = (
    'name = "cross"\n'
    + ROD.format(name="a", place='z = "2.5 mm"')
    + ROD.format(name="b", place=ACROSS)
    + """
[contacts.ab]
first = "a"
second = "b"
stiffness = "1e4 N/m"
[wrenches.p]
body = "a"
at = "tip"
force = { z = "-1 N" }
input = true
"""
)
LINK = """
name = "gap"
planar = true
[bodies.base]
kind = "link"
length = "20 cm"
radius = "1 cm"
[bodies.ball]
kind = "link"
length = "1 cm"
radius = "5 mm"
placement = { z = "3 cm" }
joint = { kind = "prismatic", axis = "z", stiffness = "1 N/m" }
[spheres.base]
bodies = ["base"]
[spheres.ball]
points = [{ body = "ball", at = "base" }]
[contacts.c]
first = "ball"
second = "base"
stiffness = "100 N/m"
"""


def warned(file: Path, changes: Any = None) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        flexor.load(file, changes=changes)
    assert all(each.category is ModelWarning for each in caught)
    assert all(each.filename == __file__ for each in caught)
    return [str(each.message) for each in caught]


@pytest.fixture
def crossing(tmp_path: Path) -> Path:
    file = tmp_path / "cross.toml"
    file.write_text(CROSSING)
    return file


def test_spheres_further_apart_than_they_are_wide(crossing: Path) -> None:
    (said,) = warned(crossing)
    each = (
        'spheres of the rod "{}" have a spacing of 3.87 mm and a diameter of 2 mm: 20 elements '
        "close the gaps (it has 10)"
    )
    assert said == f'contact "ab" may be missed: {each.format("a")}; {each.format("b")}.'
    assert issubclass(flexor.ModelWarning, UserWarning)


def test_the_elements_named_would_do_and_one_less_would_not(crossing: Path) -> None:
    for elements, count in ((19, 1), (20, 0)):
        changes = {"a.elements": elements, "b.elements": elements}
        assert len(warned(crossing, changes)) == count
    loads = [0.0, 0.02]
    with pytest.warns(ModelWarning):
        coarse = flexor.load(crossing).equilibrium(loads)
    fine = flexor.load(crossing, changes={"a.elements": 20, "b.elements": 20}).equilibrium(loads)
    assert coarse.pairs[-1] == 0
    assert fine.pairs[-1] > 0
    # By beam theory, rods of equal stiffness that cross at their ends share the load.
    force = fine.contact_forces()
    assert np.linalg.norm(np.sum(force.force, axis=0)) == pytest.approx(0.02038, rel=0.05)


def test_a_sphere_that_fits_between_those_of_a_link(tmp_path: Path) -> None:
    file = tmp_path / "gap.toml"
    file.write_text(LINK)
    (said,) = warned(file)
    assert 'spheres of the link "base" have a spacing of 100 mm and a diameter of 20 mm' in said
    assert "one of the other group fits between them" in said
    assert warned(file, {"ball.radius": "5 cm"}) == []
    assert warned(file, {"contacts.c.shape": "round-cones"}) == []


@pytest.mark.parametrize("name", ["finger", "finger-2-links", "tendon-arm", "exosuit-alone"])
def test_presets_have_no_gaps(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        flexor.load(name)


def test_commands_print_a_line(crossing: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["simulate", str(crossing), "--force", "0"])
    said = capsys.readouterr().err
    assert said.startswith('warning: contact "ab" may be missed: spheres of the rod "a" have')
    assert said.count("\n") == 1


BLADE = """
name = "blade"
planar = true
[bodies.blade]
kind = "link"
length = "10 cm"
radius = "{radius}"
{skin}
joint = {{ kind = "revolute", stiffness = "0.02 N*m/rad" }}
[obstacles.wire]
kind = "cylinder"
axis = "y"
radius = "{radius}"
point = {{ x = "{x!r} m", z = "{z!r} m" }}
{spheres}
[wrenches.w]
body = "blade"
at = "tip"
moment = {{ y = "1 N*m" }}
input = true
"""
SKIN = 'skin = { thickness = "1 mm", modulus = "10 MPa" }'


def blade(radius: str, along: float, skin: str = SKIN, spheres: str = "") -> str:
    """Write a hinged link with a wire in its way, at a place along it, 0.75 rad below."""
    x, z = along * float(np.cos(0.75)), -along * float(np.sin(0.75))
    return BLADE.format(radius=radius, skin=skin, spheres=spheres, x=x, z=z)


@pytest.mark.parametrize("along", [0.05, 0.07, 0.0625])
@pytest.mark.parametrize(("radius", "thick"), [("1 mm", 2e-3), ("0.6 mm", 1.2e-3)])
def test_a_link_with_a_skin_has_no_gaps_for_a_thin_obstacle(
    tmp_path: Path, radius: str, thick: float, along: float
) -> None:
    file = tmp_path / "blade.toml"
    file.write_text(blade(radius, along))
    assert warned(file) == []
    path = flexor.load(file).equilibrium([0.0, 0.03])
    assert path.stability[-1] == "stable"
    met = 0.75 - np.arcsin(thick / along)
    # The skins yield by a small part of their thickness.
    assert met < path.joint_angles[-1, 0] < met + 0.3 * thick / along


def test_obstacles_that_fit_between_spheres(tmp_path: Path) -> None:
    file = tmp_path / "blade.toml"
    spheres = 'spheres = ["blade"]\nstiffness = "1 N/mm"\n[spheres.blade]\nbodies = ["blade"]'
    file.write_text(blade("1 mm", 0.07, "", spheres))
    (said,) = warned(file)
    assert said == (
        'obstacle "wire" may be missed: spheres of the link "blade" have a spacing of 50 mm and a '
        "diameter of 2 mm, and it is 2 mm thick: give spheres at points that are closer together."
    )
    # Each point of a skin would have to be nearer to the next than 20 micrometres.
    file.write_text(blade("0.01 mm", 0.07))
    (said,) = warned(file)
    assert "have a spacing of 0.5 mm and a diameter of 0.02 mm, and it is 0.02 mm thick" in said


@pytest.mark.parametrize("whole", [True, False])
def test_the_elements_named_close_the_gaps_for_an_obstacle(tmp_path: Path, whole: bool) -> None:
    file = tmp_path / "rope.toml"
    skin = 'skin = { thickness = "1 mm", modulus = "1 MPa" }\nyoung_modulus'
    text = ROPE if whole else ROPE.replace("young_modulus", skin)
    if not whole:
        text = text.replace('spheres = ["rope"]\nstiffness = "1 kN/m"\n', "")
    thin = {"obstacles.bar.radius": "0.5 mm", "bodies.rope.radius": "0.5 mm"}
    file.write_text(text)
    (said,) = warned(file, thin)
    needed = int(said.split(": ")[-1].split()[0])
    assert 20 < needed < 400
    assert len(warned(file, thin | {"bodies.rope.elements": needed - 1})) == 1
    assert warned(file, thin | {"bodies.rope.elements": needed}) == []


ROPE = """
name = "rope"
planar = true
gravity = { z = "-9.81 m/s^2" }
[bodies.rope]
kind = "rod"
length = "40 cm"
radius = "5 mm"
young_modulus = "0.1 MPa"
poisson_ratio = 0.5
density = "1000 kg/m^3"
placement = { x = "-20 cm", z = "2 cm" }
strain = { bend_y = "nodal_linear", extend_x = "nodal_linear" }
elements = 20
gauss_points = 2
[spheres.rope]
bodies = ["rope"]
[obstacles.bar]
kind = "cylinder"
axis = "y"
radius = "5 mm"
spheres = ["rope"]
stiffness = "1 kN/m"
"""


def test_a_rope_that_falls_through_a_bar(tmp_path: Path) -> None:
    """Soft as it is, its first equilibrium hangs from its clamped end on this side of the bar."""
    file = tmp_path / "rope.toml"
    file.write_text(ROPE)
    with pytest.warns(ModelWarning) as caught:
        path = flexor.load(file).equilibrium()
    assert path.frames()["rope"][-1, 2, 3] < -0.3
    assert path.obstacle_forces()["bar"][0] == 0.0
    (said,) = {str(each.message) for each in caught}
    assert said.startswith('obstacle "bar" may have been passed: points of "rope" are on its other')
    # From where it hangs beside the bar there is nothing to pass.
    with warnings.catch_warnings():
        warnings.simplefilter("error", ModelWarning)
        flexor.load(file).equilibrium(start=path)
