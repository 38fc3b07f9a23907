"""Solid obstacles and sleeves against closed forms and minima of energies written out here."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from scipy.optimize import brentq, minimize

from flexor.errors import InputError
from flexor.model import Model, Path, parse

STIFFNESS = 2e3  # [N/m]


def solved(text: str, loads: list[float] | None = None) -> Path:
    path = Model(parse(text)).equilibrium(loads if loads is not None else [0.0])
    assert path.stable.all()
    return path


PROPPED = """
name = "propped"
planar = true

[bodies.beam]
kind = "rod"
length = "30 cm"
radius = "5 mm"
young_modulus = "1 GPa"
poisson_ratio = 0.3
strain = { bend_y = "nodal_linear" }
elements = 6
gauss_points = 2

[spheres.middle]
points = [{ body = "beam", at = 0.5 }]

[obstacles.bar]
spheres = ["middle"]
point = { x = "15 cm", z = "-2.5 cm" }
radius = "2 cm"
stiffness = "2 kN/m"
kind = "sphere"

[wrenches.load]
body = "beam"
at = "tip"
force = { z = "-1 N" }
input = true
"""


@pytest.mark.parametrize("kind", ['"sphere"', '"cylinder"\naxis = "y"'])
@pytest.mark.parametrize("planar", [True, False])
def test_a_beam_on_a_prop_presses_as_beam_theory_says(kind: str, planar: bool) -> None:
    text = PROPPED.replace('"sphere"', kind)
    if not planar:
        text = text.replace("planar = true", "planar = false")
    load, length, at = 1e-3, 0.3, 0.15
    path = solved(text, [0.0, load])
    bending = 1e9 * np.pi * 0.005**4 / 4.0
    rigid = load * (3.0 * length - at) / (2.0 * at)
    force = rigid / (1.0 + 3.0 * bending / (STIFFNESS * at**3))
    assert path.obstacle_forces()["bar"][-1] == pytest.approx(force, rel=1e-4)


HINGED = """
name = "hinged"
planar = true

[bodies.arm]
kind = "link"
length = "10 cm"
radius = "1 cm"
joint = { kind = "revolute", stiffness = "0.1 N*m/rad" }

[spheres.tip]
points = [{ body = "arm", at = "tip" }]

[obstacles.bar]
spheres = ["tip"]
stiffness = "2 kN/m"
SOLID

[wrenches.turn]
body = "arm"
at = "base"
moment = { y = "1 N*m" }
input = true
"""


def pressed(distance: np.ndarray | float, radius: float = 0.01) -> np.ndarray:
    """Return the energy of a sphere at this distance from a surface."""
    return 0.5 * STIFFNESS * np.square(np.maximum(radius - distance, 0.0))


def _capsule(x: float, z: float) -> float:
    # From (8.5, -6.5) to (10.5, -4.5) cm, of radius 1 cm.
    along = np.array([1.0, 1.0]) / np.sqrt(2.0)
    r = np.array([x, z]) - np.array([0.095, -0.055])
    share = np.clip(r @ along, -0.01 * np.sqrt(2.0), 0.01 * np.sqrt(2.0))
    return float(np.linalg.norm(r - share * along)) - 0.01


def _box(x: float, z: float) -> float:
    # 4 by 6 cm around (8, -7) cm, edges rounded by 5 mm.
    beyond = np.abs([x - 0.08, z + 0.07]) - [0.015, 0.025]
    return float(np.linalg.norm(np.maximum(beyond, 0.0))) - 0.005


@pytest.mark.parametrize(
    ("solid", "distance"),
    [
        (
            'kind = "capsule"\nradius = "1 cm"\nlength = "2.8284271247461903 cm"\n'
            'axis = [1, 0, 1]\npoint = { x = "9.5 cm", z = "-5.5 cm" }',
            _capsule,
        ),
        (
            'kind = "box"\nsize = { x = "4 cm", z = "6 cm" }\nrounding = "5 mm"\n'
            'point = { x = "8 cm", z = "-7 cm" }',
            _box,
        ),
        (
            'kind = "cylinder"\naxis = [1, 0, 0]\nradius = "4.5 cm"\ninside = true',
            lambda x, z: 0.045 - abs(z),
        ),
        (
            'kind = "box"\nsize = { x = "25 cm", z = "9 cm" }\ninside = true',
            lambda x, z: min(0.045 - abs(z), 0.125 - abs(x)),
        ),
    ],
)
def test_a_link_turns_until_an_obstacle_holds_it(solid: str, distance) -> None:  # type: ignore[no-untyped-def]
    path = solved(HINGED.replace("SOLID", solid), [0.0, 0.1, 0.3])

    def energy(angle: float, moment: float) -> float:
        tip = distance(0.1 * np.cos(angle), -0.1 * np.sin(angle))
        return float(0.05 * angle**2 - moment * angle + pressed(tip))

    def slope(angle: float, moment: float) -> float:
        return (energy(angle + 1e-6, moment) - energy(angle - 1e-6, moment)) / 2e-6

    for angle, moment in zip(path.q[1:, 0], (0.1, 0.3), strict=True):
        assert brentq(slope, 0.0, angle + 0.05, args=(moment,)) == pytest.approx(angle, abs=1e-6)
    tip = distance(*(0.1 * np.array([np.cos(path.q[-1, 0]), -np.sin(path.q[-1, 0])])))
    force = STIFFNESS * (0.01 - tip)
    assert force > 0.5
    assert path.obstacle_forces()["bar"][-1] == pytest.approx(force, rel=1e-9)


def test_a_free_link_rests_in_a_bowl() -> None:
    """Both of its ends touch the sphere from inside, and it neither slides nor tilts."""
    text = """
    name = "bowl"
    planar = true
    gravity = { z = "-9.81 m/s^2" }

    [bodies.stick]
    kind = "link"
    length = "6 cm"
    radius = "1 cm"
    density = "1000 kg/m^3"
    joint = { kind = "free" }
    placement = { x = "-2 cm", z = "-1 cm" }

    [spheres.ends]
    points = [{ body = "stick", at = "base" }, { body = "stick", at = "tip" }]

    [obstacles.bowl]
    kind = "sphere"
    inside = true
    radius = "10 cm"
    spheres = ["ends"]
    stiffness = "2 kN/m"
    """
    path = solved(text)
    weight = 9.81 * 1000.0 * np.pi * 0.01**2 * 0.06

    def balance(z: float) -> float:
        far = np.hypot(0.03, z)
        return float(2.0 * STIFFNESS * (0.01 - 0.1 + far) * -z / far - weight)

    height = brentq(balance, -0.1, -0.05)
    ends = path.frames(-1)["stick"][[0, -1], :3, 3]
    np.testing.assert_allclose(ends, [[-0.03, 0.0, height], [0.03, 0.0, height]], atol=1e-7)
    np.testing.assert_allclose(path.contact_forces(-1).force.sum(axis=0)[2], weight, rtol=1e-7)


def free_link(planar: bool, held: str = "", place: str = "") -> str:
    """A free link with weight and a sphere at each end, held by the stiffness of its joint."""
    return f"""
    name = "stick"
    planar = {str(planar).lower()}
    gravity = {{ z = "-9.81 m/s^2" }}

    [bodies.stick]
    kind = "link"
    length = "6 cm"
    radius = "1 cm"
    density = "1000 kg/m^3"
    joint = {{ kind = "free"{held} }}
    placement = {{ {place} }}

    [spheres.ends]
    points = [{{ body = "stick", at = "base" }}, {{ body = "stick", at = "tip" }}]
"""


@pytest.mark.parametrize("planar", [True, False])
def test_a_free_link_rests_on_the_floor_of_a_box(planar: bool) -> None:
    """In the plane it may slide, which is said; in space a small stiffness keeps it in place."""
    held = "" if planar else ', stiffness = "1e-4 N*m/rad", linear_stiffness = "0.01 N/m"'
    text = f"""{free_link(planar, held)}
    [obstacles.box]
    kind = "box"
    inside = true
    size = {{ x = "20 cm", y = "20 cm", z = "10 cm" }}
    spheres = ["ends"]
    stiffness = "2 kN/m"
    """
    path = Model(parse(text)).equilibrium([0.0])
    assert path.converged.all()
    assert path.stability[0] == ("neutral" if planar else "stable")
    weight = 9.81 * 1000.0 * np.pi * 0.01**2 * 0.06
    sunk = weight / (2.0 * STIFFNESS + (0.0 if planar else 0.01))
    heights = path.frames(-1)["stick"][[0, -1], 2, 3]
    np.testing.assert_allclose(heights, -0.05 + 0.01 - sunk, atol=1e-6)


@pytest.mark.parametrize(
    ("planar", "place", "stiffness", "free"),
    [
        (
            True,
            'x = "3.8 cm", z = "5.8 cm", rotation = { y = "-1 deg" }',
            "20 MN/m",
            ("x", "z"),
        ),
        (
            False,
            'x = "-1.8 cm", y = "-5 mm", z = "4.7 cm", rotation = { y = "-30 deg" }',
            "200 kN/m",
            ("x", "z"),
        ),
    ],
)
def test_a_free_link_rolls_off_a_stiff_capsule(
    planar: bool, place: str, stiffness: str, free: tuple[str, ...]
) -> None:
    """It leaves the surface and falls on it again, until nothing holds it."""
    shape = (
        'axis = [-0.75, 0, -0.66]\nlength = "9 cm"\nradius = "1.2 cm"'
        if planar
        else 'axis = "y"\nlength = "9 cm"\nradius = "2.2 cm"'
    )
    text = f"""{free_link(planar, place=place)}
    [obstacles.bar]
    kind = "capsule"
    {shape}
    spheres = ["ends"]
    stiffness = "{stiffness}"
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        path = Model(parse(text)).equilibrium([0.0])
    assert path.status.tolist() == ["unrestrained"]
    assert {f"stick.{axis}" for axis in free} <= set(path.free[0])
    # Before, 20,000.
    assert path.iterations[0] < 300


def test_a_chain_hangs_over_a_cylinder() -> None:
    count, length, radius = 6, 0.03, 0.005
    links = "".join(
        f"""
        [bodies.link_{i}]
        kind = "link"
        length = "3 cm"
        radius = "5 mm"
        density = "2000 kg/m^3"
        joint = {{ kind = "revolute", stiffness = "1e-3 N*m/rad" }}
        """
        + (f'parent = "link_{i - 1}"\n' if i else "")
        for i in range(count)
    )
    points = ", ".join(f'{{ body = "link_{i}", at = "tip" }}' for i in range(count))
    text = f"""
    name = "chain"
    planar = true
    gravity = {{ z = "-9.81 m/s^2" }}
    {links}
    [spheres.chain]
    points = [{points}]

    [obstacles.drum]
    kind = "cylinder"
    axis = "y"
    radius = "4 cm"
    point = {{ x = "7 cm", z = "-5 cm" }}
    spheres = ["chain"]
    stiffness = "2 kN/m"
    """
    path = solved(text)
    weight = 9.81 * 2000.0 * np.pi * radius**2 * length

    def energy(q: np.ndarray) -> float:
        turned = np.cumsum(q)
        steps = length * np.stack([np.cos(turned), -np.sin(turned)], axis=1)
        ends = np.cumsum(steps, axis=0)
        middles = ends - 0.5 * steps
        gaps = np.linalg.norm(ends - [0.07, -0.05], axis=1) - 0.04
        return float(0.5e-3 * q @ q + weight * middles[:, 1].sum() + pressed(gaps, radius).sum())

    assert (np.hypot(*(path.contact_forces(-1).force[:, [0, 2]].T)) > 0.05).sum() >= 2
    found = minimize(energy, path.q[-1], method="BFGS", options={"gtol": 1e-9})
    np.testing.assert_allclose(path.q[-1], found.x, atol=2e-5)


CARRIED = """
name = "carried"
planar = true

[bodies.press]
kind = "link"
length = "2 cm"
radius = "1 cm"
placement = { x = "4 cm", z = "3 cm" }
joint = { kind = "prismatic", axis = "z", stiffness = "50 N/m" }

[bodies.lever]
kind = "link"
length = "10 cm"
radius = "5 mm"
joint = { kind = "revolute", stiffness = "0.1 N*m/rad" }

[spheres.foot]
points = [{ body = "press", at = "tip" }]

[obstacles.pad]
SOLID
spheres = ["foot"]
stiffness = "2 kN/m"

[wrenches.push]
body = "press"
at = "base"
force = { z = "-1 N" }
input = true
"""


@pytest.mark.parametrize(
    ("solid", "distance"),
    [
        (
            'kind = "sphere"\nradius = "1 cm"\n'
            'point = { body = "lever", at = "tip", offset = { x = "-3 cm", z = "1 cm" } }',
            lambda x, z: np.hypot(x - 0.07, z - 0.01) - 0.01,
        ),
        (
            'kind = "half-space"\nnormal = "z"\n'
            'point = { body = "lever", at = "base", offset = { z = "1 cm" } }',
            lambda x, z: z - 0.01,
        ),
    ],
)
@pytest.mark.parametrize("planar", [True, False])
def test_an_obstacle_on_a_body_pushes_it(solid: str, distance, planar: bool) -> None:  # type: ignore[no-untyped-def]
    text = CARRIED.replace("SOLID", solid)
    path = solved(text if planar else text.replace("planar = true", ""), [0.0, 1.0, 4.0])

    def energy(q: np.ndarray) -> float:
        x, z = 0.06, 0.03 + q[0]
        cos, sin = np.cos(q[1]), np.sin(q[1])
        local = distance(cos * x - sin * z, sin * x + cos * z)
        return float(25.0 * q[0] ** 2 + 0.05 * q[1] ** 2 + 4.0 * q[0] + pressed(local))

    assert path.q[-1, 1] > 0.1
    found = minimize(energy, path.q[-1], method="BFGS", options={"gtol": 1e-9})
    np.testing.assert_allclose(path.q[-1], found.x, atol=1e-6)


BASE = 'kind = "sphere"\nradius = "1 cm"\npoint = { x = "15 cm", z = "-2.5 cm" }'


@pytest.mark.parametrize(
    ("solid", "sentence"),
    [
        (
            'kind = "sphere"\nradius = "3 cm"\npoint = { x = "2 cm" }',
            'obstacles.bar contains the base of "beam" at rest, which is at (0, 0, 0) cm: move',
        ),
        (
            'kind = "box"\nsize = { x = "3 cm", z = "3 cm" }\npoint.x = "5 cm"\ninside = true',
            'obstacles.bar contains the base of "beam" at rest',
        ),
        (
            'kind = "half-space"\nnormal = "z"\npoint = { z = "1 cm" }',
            'obstacles.bar contains the base of "beam" at rest',
        ),
        ('kind = "sphere"', "obstacles.bar.radius is missing"),
        ('kind = "sphere"\nradius = "0 m"', 'obstacles.bar.radius is "0 m"'),
        ('kind = "cylinder"\nradius = "1 cm"\naxis = [0, 0, 0]', "obstacles.bar.axis has no"),
        (
            'kind = "cylinder"\nradius = "1 cm"\naxis = [0, 1, 1]\npoint.z = "9 cm"',
            "obstacles.bar.axis is [0.0, 1.0",
        ),
        ('kind = "capsule"\nradius = "1 cm"\naxis = "x"', "obstacles.bar.length is missing"),
        ('kind = "box"\nsize = { x = "1 cm" }', "obstacles.bar.size.z is missing"),
        (
            'kind = "box"\nsize = { x = "1 cm", z = "2 cm" }\nrounding = "6 mm"',
            'obstacles.bar.rounding is "6 mm": it must be at most half of the smallest size, "1',
        ),
        (
            'kind = "box"\nsize = { x = "90 cm", z = "90 cm" }\nrounding = "1 mm"\ninside = true',
            'obstacles.bar.rounding is "1 mm": the walls of a box that is open inside have none',
        ),
        (
            'kind = "box"\nsize = {x = "1 cm", z = "2 cm"}\nrotation.x = "1 deg"\npoint.z = "9 m"',
            "obstacles.bar.rotation.x is",
        ),
        (
            'kind = "sphere"\nradius = "1 cm"\npoint = { body = "beam", at = "tip" }',
            'obstacles.bar.spheres names the group "middle", which has spheres on "beam"',
        ),
        (
            'kind = "sphere"\nradius = "1 cm"\npoint = { body = "beem", at = "tip" }',
            'obstacles.bar.point.body refers to the unknown body "beem"',
        ),
    ],
)
def test_what_makes_no_obstacle_is_refused(solid: str, sentence: str) -> None:
    start, end = PROPPED.index("point = { x"), PROPPED.index("[wrenches")
    text = PROPPED[:start] + 'stiffness = "2 kN/m"\n' + solid + "\n" + PROPPED[end:]
    with pytest.raises(InputError) as caught:
        parse(text)
    assert sentence in str(caught.value)
    assert str(caught.value).count(".\n") == 0


def test_a_box_in_space_has_a_size_along_y() -> None:
    text = PROPPED.replace("planar = true", "").replace(
        'radius = "2 cm"\nstiffness', 'size = { x = "1 cm", z = "1 cm" }\nstiffness'
    )
    with pytest.raises(InputError, match=r"obstacles\.bar\.size\.y is missing"):
        parse(text.replace('"sphere"', '"box"'))
