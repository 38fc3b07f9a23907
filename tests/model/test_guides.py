"""Friction of tendons in their guides: the capstan equation, memory, energy, and derivatives."""

from __future__ import annotations

import json
from pathlib import Path as FilePath

import numpy as np
import pytest

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model import Model, parse
from flexor.model.derivatives import differentiate, last_step
from flexor.model.geometry import SlotValues
from flexor.scene import scene

RADIUS, SPRING = 0.03, 500.0


def belt(friction: float, angle: float, guides: int, stiffness: str = "100 N/mm") -> Model:
    """Return a cable that guides turn by an angle and that draws a carriage against a spring."""
    around = np.linspace(0.0, angle, guides)
    places = [(-0.05, RADIUS), *zip(RADIUS * np.sin(around), RADIUS * np.cos(around), strict=True)]
    along = np.array([np.cos(angle), -np.sin(angle)])
    x, z = np.array(places[-1]) + 0.1 * along
    path = ", ".join(f'{{ world = {{ x = "{a:.15g} m", z = "{b:.15g} m" }} }}' for a, b in places)
    axis = f"[{along[0]:.15g}, 0.0, {along[1]:.15g}]"
    return Model(
        parse(f"""
name = "belt"
planar = true

[bodies.carriage]
kind = "link"
length = "1 cm"
radius = "1 mm"
placement = {{ x = "{x:.15g} m", z = "{z:.15g} m" }}
joint = {{ kind = "prismatic", axis = {axis}, stiffness = "{SPRING} N/m" }}

[tendons.cable]
kind = "cable"
path = [{path}, {{ body = "carriage", at = "base" }}]
friction = {friction}
slip_stiffness = "{stiffness}"
""")
    )


def drawn(model: Model, loads: Array | list[float]) -> tuple[Array, Array]:
    """Return the tension that arrives [N] and the energy dissipated [J] at each load."""
    path = model.equilibrium(loads)
    assert path.converged.all() and path.stable.all() and not path.events
    return -SPRING * path.q[:, 0], path.dissipated


@pytest.mark.parametrize("friction", [0.1, 0.3, 0.8])
@pytest.mark.parametrize(("angle", "guides"), [(0.5 * np.pi, 5), (np.pi, 20), (2.0 * np.pi, 40)])
def test_the_tension_that_arrives_is_that_of_the_capstan_equation(
    friction: float, angle: float, guides: int
) -> None:
    tension, _ = drawn(belt(friction, angle, guides), [0.0, 10.0, 20.0])
    np.testing.assert_allclose(
        tension, np.exp(-friction * angle) * np.array([0, 10, 20]), rtol=1e-9
    )


def test_a_pull_that_turns_round_moves_nothing_within_its_dead_band() -> None:
    friction, angle = 0.3, 0.5 * np.pi
    ratio = np.exp(friction * angle)
    top = 10.0 / ratio
    down = np.linspace(10.0, 0.5, 39)
    up = np.linspace(0.5, 10.0, 39)
    loads = np.concatenate([[0.0, 5.0, 10.0], down[1:], up[1:]])
    tension, dissipated = drawn(belt(friction, angle, 10, "10 kN/mm"), loads)
    # Down: the tension stays until the pull is below it by the ratio; up likewise.
    expected = np.concatenate([loads[:3] / ratio, np.minimum(top, down[1:] * ratio)])
    expected = np.append(expected, np.maximum(0.5 * ratio, up[1:] / ratio))
    np.testing.assert_allclose(tension, expected, rtol=2e-4, atol=1e-12)
    # The area of the loop of the pull over the length drawn is lost.
    x = tension / SPRING
    lost = np.sum(0.5 * (loads[3:] + loads[2:-1]) * np.diff(x[2:]))
    assert dissipated[-1] - dissipated[2] == pytest.approx(lost, rel=0.03)
    assert (np.diff(dissipated) > -1e-12).all()


def test_the_way_up_does_not_depend_on_its_steps() -> None:
    one, many = (drawn(belt(0.3, np.pi, 12), np.linspace(0.0, 10.0, n)) for n in (2, 60))
    assert one[0][-1] == pytest.approx(many[0][-1], rel=1e-9)


def test_a_pull_that_is_held_moves_nothing() -> None:
    path = belt(0.3, np.pi, 12).equilibrium([0.0, 10.0, 7.0, *[7.0] * 1000])
    assert (path.q[2:] == path.q[2]).all()
    assert (path.dissipated[2:] == path.dissipated[2]).all()


def test_energy_balances() -> None:
    """Work of the pull is stored in the spring and at guides, or dissipated, to first order."""

    def gap(steps: int) -> float:
        loads = np.concatenate([np.linspace(0, 10, steps), np.linspace(10, 1, steps)[1:]])
        path = belt(0.3, np.pi, 8).equilibrium(loads)
        x = -path.q[:, 0]
        work = np.sum(0.5 * (loads[1:] + loads[:-1]) * np.diff(x))
        slips = path.friction_forces(len(loads) - 1).slip
        stored = 0.5 * SPRING * x[-1] ** 2 + 0.5 * 1e5 * np.sum(slips**2)
        return float(abs(work - stored - path.dissipated[-1]) / work)

    gaps = [gap(steps) for steps in (10, 20, 40)]
    assert gaps[2] < 0.02
    assert gaps[1] < 0.55 * gaps[0] and gaps[2] < 0.55 * gaps[1]


def test_what_is_said_of_guides(tmp_path: FilePath) -> None:
    model = belt(0.3, 0.5 * np.pi, 4)
    whole = model.equilibrium([0.0, 10.0, 9.9, 9.0])
    found = whole.friction_forces(1)
    assert set(found.name) == {"cable"} and found.slides.all()
    assert found.sphere.tolist() == [0, 1, 2, 3]
    lost = np.linalg.norm(found.force, axis=1)
    assert 10.0 - lost.sum() == pytest.approx(-SPRING * whole.q[1, 0], rel=1e-9)
    np.testing.assert_allclose(lost, found.limit, rtol=1e-9)
    np.testing.assert_allclose(1e5 * np.abs(found.slip), np.abs(found.force), atol=1e-9)
    file = tmp_path / "drawn.json"
    first = model.equilibrium([0.0, 10.0, 9.9])
    file.write_text(json.dumps(first.to_dict()), encoding="utf-8")
    for start in (first, first[-1], str(file)):
        path = model.equilibrium([9.9, 9.0], start=start)
        np.testing.assert_allclose(path.q, whole.q[2:], rtol=1e-9)
    assert any(each.kind == "friction" for each in scene(whole).objects)


def test_a_slack_tendon_has_no_friction() -> None:
    tension, _ = drawn(belt(0.5, np.pi, 8), [0.0, 0.0, 5.0, 0.0])
    assert tension[2] == pytest.approx(5.0 * np.exp(-0.5 * np.pi), rel=1e-9)
    np.testing.assert_allclose(tension[[0, 1, 3]], 0.0, atol=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("friction = 0.3", "friction = -0.3", "tendons.cable.friction is -0.3"),
        ("friction = 0.3\n", "", "tendons.cable.slip_stiffness is given without friction"),
        ("GUIDE, ", "", "tendons.cable.friction acts at no point"),
        ("GUIDE", '{ wrap = "post" }', "tendons.cable.friction acts at points"),
    ],
)
def test_what_is_no_friction_of_a_tendon_is_said_in_a_sentence(
    old: str, new: str, sentence: str
) -> None:
    text = """
name = "belt"
[bodies.arm]
kind = "link"
length = "5 cm"
radius = "5 mm"
joint = { kind = "revolute", axis = "y", stiffness = "1 N m/rad" }
[wraps.post]
kind = "sphere"
point = { world = { z = "1 cm" } }
radius = "5 mm"
[tendons.cable]
kind = "cable"
path = [{ world = { x = "-5 cm" } }, GUIDE, { body = "arm", at = "tip" }]
friction = 0.3
slip_stiffness = "50 N/mm"
"""
    with pytest.raises(InputError) as caught:
        parse(text.replace(old, new).replace("GUIDE", "{ world = { z = '1 cm' } }"))
    assert sentence in str(caught.value)
    assert str(caught.value).count("\n") == 0


# A cable and an elastic tendon that are laced through guides on a rod and a hand, drawn to and fro.
LACED = """
name = "laced"
planar = {planar}

[bodies.arm]
kind = "rod"
length = "10 cm"
radius = "6 mm"
young_modulus = "1 MPa"
poisson_ratio = 0.5
joint = {{ kind = "fixed" }}
strain = {{ {strain} }}
elements = 4
gauss_points = 2

[bodies.hand]
kind = "link"
parent = "arm"
length = "3 cm"
radius = "5 mm"
joint = {{ kind = "revolute", axis = "y", stiffness = "0.02 N m/rad" }}

[tendons.flexor]
kind = "cable"
path = [
  {{ world = {{ x = "-2 cm", z = "-1 cm" }} }},
  {{ body = "arm", at = 0.25, offset = {{ z = "-8 mm"{y} }} }},
  {{ body = "arm", at = 0.5, offset = {{ z = "-12 mm" }} }},
  {{ body = "arm", at = 0.75, offset = {{ z = "-8 mm" }} }},
  {{ body = "hand", at = 0.5, offset = {{ z = "-9 mm"{y} }} }},
  {{ body = "hand", at = "tip", offset = {{ z = "-5 mm" }} }},
]
friction = 0.3

[tendons.extensor]
kind = "spring"
stiffness = "80 N/m"
slack_length = "13 cm"
path = [
  {{ world = {{ x = "-2 cm", z = "2 cm" }} }},
  {{ body = "arm", at = 0.5, offset = {{ z = "12 mm" }} }},
  {{ body = "hand", at = 0.2, offset = {{ z = "8 mm"{y} }} }},
  {{ body = "hand", at = "tip", offset = {{ z = "5 mm" }} }},
]
friction = 0.2
"""
VARIED = (
    ("arm.length", 0.1),
    ("arm.young_modulus", 0.2),
    ("hand.length", 0.1),
    ("flexor.friction", 0.3),
    ("extensor.friction", 0.3),
    ("extensor.stiffness", 0.3),
    ("extensor.slack_length", 0.03),
)


@pytest.mark.parametrize("planar", [True, False])
def test_derivatives_through_the_history_are_those_of_differences(planar: bool) -> None:
    modes = ["bend_y", "extend_x"] if planar else ["bend_y", "bend_z", "twist_x"]
    strain = ", ".join(f'{mode} = "nodal_linear"' for mode in modes)
    side = "" if planar else ', y = "3 mm"'
    model = Model(parse(LACED.format(planar=str(planar).lower(), strain=strain, y=side)))
    # In newtons; from 1 N on the finger snaps.
    loads = 0.12 * np.array([0.0, 1.0, 3.0, 5.0, 5.0, 4.6, 3.0, 3.5])[:, None]
    slots = np.array([model.engine.slots[name][0] for name, _ in VARIED])
    random = np.random.default_rng(3)
    spread = np.array([each for _, each in VARIED])
    values = model.parameters[slots] * (1 + spread * random.uniform(-1, 1, (12, len(slots))))

    def ends(values: Array, loads: Array) -> tuple[Array, Array]:
        paths = model.evaluate(SlotValues(slots, values), loads, 1)
        good = (paths.converged & paths.stable).all(axis=1)
        return paths.joint_angles[:, -1], good

    paths = model.evaluate(SlotValues(slots, values), loads, 1)
    assert (paths.converged & paths.stable).all()
    sliding = np.array([[each["slides"] for each in row[1:]] for row in paths.friction])
    assert sliding.any() and not sliding.all(axis=(0, 1)).any()
    found = differentiate(paths, last_step(paths)[:-1], slots, 1)
    regular = (found.regularity == "regular").all(axis=1)
    assert regular.mean() > 0.7
    scale = np.abs(model.parameters[slots])
    slopes = np.zeros_like(found.by_slots)
    for column, size in enumerate(1e-5 * scale):
        for sign in (-1.0, 1.0):
            moved = values.copy()
            moved[:, column] += sign * size
            end, good = ends(moved, loads)
            regular &= good
            slopes[:, :, column] += sign * end / (2.0 * size)
    assert (np.abs(slopes).max(axis=(0, 1)) > 0.0).all()
    error = np.abs((found.by_slots - slopes) * scale)
    size = np.abs(slopes * scale).max(axis=(0, 2))[None, :, None]
    assert np.quantile((error / size)[regular].max(axis=(1, 2)), 0.9) < 1e-5
    assert np.median((error / size)[regular]) < 1e-7
    # An early load has its part in the end.
    design = int(np.flatnonzero(regular)[0])
    for step in (3, 5, 7):
        turned = []
        for sign in (-1.0, 1.0):
            moved = loads.copy()
            moved[step] += sign * 1e-5
            if step == 3:
                moved[4] = moved[3]
            turned.append(ends(values[design : design + 1], moved)[0][0])
        slope = (turned[1] - turned[0]) / 2e-5
        exact = found.by_loads[design, :, step, 0]
        exact = exact + (found.by_loads[design, :, 4, 0] if step == 3 else 0.0)
        np.testing.assert_allclose(exact, slope, atol=1e-5 * np.abs(found.by_loads).max())
