"""Pressures controlled by the volume of their cavity, chambers and cables by their length."""

from __future__ import annotations

from pathlib import Path as FilePath

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid
from scipy.optimize import minimize_scalar

from flexor.design import parameter_set
from flexor.errors import InputError
from flexor.model import Model, load, parse

EXAMPLE = FilePath(__file__).parents[2] / "examples" / "pneumatic-finger.toml"
VOLUME = {"actuators.chamber.control": "volume"}
TIGHT = {"tolerance": 1e-12}

# Stiffens little, so that the pressure has a maximum: w = mu/alpha (λ^α + 2 λ^(-α/2) - 3).
BALLOON = """
name = "balloon"
planar = true

[materials.latex]
kind = "ogden"
mu = ["300 kPa"]
alpha = [0.5]

[bodies.tube]
kind = "rod"
length = "10 cm"
radius = "10 mm"
material = "latex"
section = { kind = "tube", wall = "2 mm" }
strain = { extend_x = { basis = "monomial", order = 0 } }
elements = 2
gauss_points = 2

[actuators.air]
kind = "pressure"
rod = "tube"
control = "volume"
"""

# A bar drawn along its axis, whose tip a compressed strut passes: a von Mises truss.
TRUSS = """
name = "truss"
planar = true

[bodies.bar]
kind = "rod"
length = "10 cm"
radius = "5 mm"
section = { kind = "stiffness", EA = "20 N", EI_yy = "1e-3 N*m^2" }
strain = { extend_x = { basis = "monomial", order = 0 } }
elements = 2
gauss_points = 2

[springs.strut]
first = { body = "bar", at = "tip" }
second = { world = { x = "9 cm", z = "2 cm" } }
stiffness = "4000 N/m"
rest_length = "2.2360679774997896 cm"

[actuators.wire]
kind = "cable"
rod = "bar"
control = "length"
"""


def latex(stretch: np.ndarray) -> np.ndarray:
    """Nominal stress [Pa]."""
    return 3e5 * (stretch**-0.5 - stretch**-1.25)


def test_a_tube_passes_its_greatest_pressure() -> None:
    model = Model(parse(BALLOON))
    path = model.equilibrium("0:180:2 mL")
    assert path.stable.all() and not path.events
    cavity, wall = np.pi * 0.008**2, np.pi * (0.010**2 - 0.008**2)
    stretch = 1.0 + path.force / (0.1 * cavity)
    exact = wall / cavity * latex(stretch)
    pressure = path.found_loads()["air"]
    np.testing.assert_allclose(pressure, exact, rtol=1e-8, atol=1e-4)
    np.testing.assert_allclose(path.volume[:, 0] - path.volume[0, 0], path.force, atol=1e-14)
    top = int(np.argmax(pressure))
    assert 0 < top < len(path) - 10
    assert path.max_strain[top] + 1.0 == pytest.approx(2.5 ** (4 / 3), abs=0.06)
    # Under pressure it bursts there.
    free = load(model.file, changes={"actuators.air.control": "pressure"})
    burst = free.equilibrium([0.0, 0.999 * pressure.max(), 1.01 * pressure.max()])
    assert burst.converged[:2].all() and not burst.stable[2]


def test_a_long_tube_bulges_there() -> None:
    uniform = 'extend_x = { basis = "monomial", order = 0 }'
    text = BALLOON.replace(uniform, 'bend_y = "nodal_linear", extend_x = "nodal_linear"')
    path = Model(parse(text)).equilibrium("0:60:2 mL")
    (first,) = path.events
    # A uniform state is a minimum of energy as long as the stress rises with the stretch.
    stretch = 1.0 + first.force / (0.1 * np.pi * 0.008**2)
    assert stretch == pytest.approx(2.5 ** (4 / 3), rel=2e-3)


def test_a_truss_is_held_through_its_limit_points() -> None:
    model = Model(parse(TRUSS))
    path = model.equilibrium("0:24:0.5 mm")
    assert path.stable.all() and not path.events
    drawn = path.force
    strut = np.hypot(0.01 - drawn, 0.02)
    rest = 2.2360679774997896e-2
    push = 4000.0 * (strut - rest) * (drawn - 0.01) / strut
    np.testing.assert_allclose(path.found_loads()["wire"], 20.0 * drawn / 0.1 + push, atol=1e-8)
    np.testing.assert_allclose(path.length("wire"), 0.1 - drawn, rtol=1e-8)
    assert np.diff(path.found_loads()["wire"]).min() < 0.0 < np.diff(path.found_loads()["wire"])[0]
    free = load(model.file, changes={"actuators.wire.control": "force"})
    assert [event.kind for event in free.equilibrium("0:5:0.1").events] == ["snap"]


def test_a_soft_tail_snaps_though_the_length_is_held() -> None:
    tail = """
[bodies.tail]
kind = "rod"
parent = "bar"
length = "5 cm"
radius = "5 mm"
section = { kind = "stiffness", EA = "10 N", EI_yy = "1e-3 N*m^2" }
strain = { extend_x = { basis = "monomial", order = 0 } }
elements = 2
gauss_points = 2

[springs.strut]"""
    text = TRUSS.replace("[springs.strut]", tail.lstrip())
    text = text.replace('body = "bar", at', 'body = "tail", at').replace('"9 cm"', '"14 cm"')
    path = Model(parse(text)).equilibrium("0:24:1 mm")
    assert path.stable.all()
    (event,) = path.events
    assert event.kind == "snap"

    def push(moved: float) -> float:
        strut = np.hypot(0.01 - moved, 0.02)
        return float(4000.0 * (1.0 - 2.2360679774997896e-2 / strut) * (moved - 0.01))

    # The tail, of 200 N/m, is shortened by what the strut pushes: drawn = moved + push / 200.
    fold = minimize_scalar(lambda s: -s - push(s) / 200.0, bounds=(0.0, 0.01), method="bounded")
    assert event.force == pytest.approx(-float(fold.fun), rel=1e-4)


def test_the_branch_is_that_of_arc_length() -> None:
    model = Model(parse(TRUSS))
    path = model.equilibrium("0:24:0.5 mm")
    free = load(model.file, changes={"actuators.wire.control": "force"})
    branch = free.equilibrium([0.0, float(path.applied[-1, 0])], follow="arc-length")
    drawn = 0.1 - branch.length("wire")
    again = model.equilibrium(drawn.tolist())
    np.testing.assert_allclose(again.applied[:, 0], branch.force, atol=1e-7)
    assert "unstable" in branch.stability and again.stable.all()


def test_found_loads_do_the_work() -> None:
    device = load(EXAMPLE, changes=VOLUME)
    path = device.equilibrium("0:3:0.01 mL")
    assert path.stable.all()
    work = cumulative_trapezoid(path.applied[:, 0], path.force, initial=0.0)
    np.testing.assert_allclose(path.energy - path.energy[0], work, rtol=1e-4, atol=1e-7)


def test_volumes_lead_to_the_states_of_their_pressures() -> None:
    device = load(EXAMPLE)
    path = device.equilibrium("0:60:10 kPa", **TIGHT)
    syringe = load(EXAMPLE, changes=VOLUME)
    added = path.volume[:, 0] - path.volume[0, 0]
    again = syringe.equilibrium(added.tolist(), **TIGHT)
    assert again.stable.all()
    np.testing.assert_allclose(again.applied[:, 0], path.force, rtol=1e-9, atol=1e-5)
    np.testing.assert_allclose(again.q, path.q, atol=1e-9)
    # And each is an equilibrium under the pressure found.
    for step in range(len(again)):
        residual = syringe.engine.residual(again.parameters, again.q[step], again.applied[step])
        assert np.abs(residual).max() < 1e-9


def test_a_state_under_pressure_is_one_under_volume() -> None:
    pressed = load(EXAMPLE).equilibrium("0:60:30 kPa")
    syringe = load(EXAMPLE, changes=VOLUME)
    there = float(pressed.volume[-1, 0] - pressed.volume[0, 0])
    path = syringe.equilibrium([there], start=pressed)
    np.testing.assert_allclose(path.applied[0, 0], 60e3, rtol=1e-8)
    back = load(EXAMPLE).equilibrium("60 kPa", start=path[0])
    np.testing.assert_allclose(back.q, pressed.q[-1:], atol=1e-7)


def test_a_held_volume_moves_nothing() -> None:
    syringe = load(EXAMPLE, changes=VOLUME)
    path = syringe.equilibrium([0.0, 1e-6, *[2e-6] * 100, 1e-6, 0.0])
    assert path.stable.all()
    assert (path.q[2:102] == path.q[2]).all()
    np.testing.assert_allclose(path.q[-1], path.q[0], atol=1e-7)


def test_derivatives_are_those_of_differences() -> None:
    syringe = load(EXAMPLE, changes=VOLUME)
    chosen = parameter_set("L+R01", syringe.design)
    span = chosen.upper - chosen.lower
    p = chosen.lower + span * np.random.default_rng(3).uniform(0.2, 0.8, (4, chosen.size))
    loads = "0:3:1 mL"
    here = syringe.evaluate(chosen.geometry(p, syringe.X), loads, gradient=True, **TIGHT)
    exact = here.chained(chosen.jacobian(p, syringe.X)) * span
    regular = here.regularity == "regular"
    assert regular.any()
    h = 1e-5
    for k in range(chosen.size):
        ends = []
        for sign in (1, -1):
            moved = p.copy()
            moved[:, k] += sign * h * span[k]
            batch = syringe.evaluate(chosen.geometry(moved, syringe.X), loads, **TIGHT)
            ends.append(batch.joint_angles[:, -1])
        difference = (ends[0] - ends[1]) / (2 * h)
        size = np.abs(exact[:, :3]).max()
        np.testing.assert_allclose(
            exact[regular, :3, k], difference[regular], atol=1e-6 * float(size)
        )


def finger(control: str, **changes: str) -> Model:
    return load("finger", changes={"actuators.chamber.control": control, **changes})


def test_derivatives_at_a_held_length_are_those_of_differences() -> None:
    model = finger("length")
    chosen = parameter_set("L+R01", model.design)
    span = chosen.upper - chosen.lower
    p = chosen.lower + span * np.random.default_rng(8).uniform(0.2, 0.8, (6, chosen.size))
    loads = "0:6:1 mm"
    here = model.evaluate(chosen.geometry(p, model.X), loads, gradient=True, tolerance=1e-11)
    exact = here.chained(chosen.jacobian(p, model.X)) * span
    regular = here.regularity == "regular"
    assert regular.any()
    h = 1e-5
    for k in range(chosen.size):
        ends = []
        for sign in (1, -1):
            moved = p.copy()
            moved[:, k] += sign * h * span[k]
            batch = model.evaluate(chosen.geometry(moved, model.X), loads, tolerance=1e-11)
            ends.append(batch.joint_angles[:, -1])
        difference = (ends[0] - ends[1]) / (2 * h)
        size = np.abs(exact[:, :3]).max()
        np.testing.assert_allclose(
            exact[regular, :3, k], difference[regular], atol=1e-5 * float(size)
        )


def test_results_do_not_depend_on_threads() -> None:
    syringe = load(EXAMPLE, changes=VOLUME)
    chosen = parameter_set("L+R01", syringe.design)
    p = np.random.default_rng(2).uniform(chosen.lower, chosen.upper, (40, chosen.size))
    geometry = chosen.geometry(p, syringe.X)
    one, two = (
        syringe.evaluate(geometry, "0:3:1 mL", threads=threads, gradient=True) for threads in (1, 2)
    )
    for name in ("q", "applied", "volume", "energy", "gradient"):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()
    added = one.volume[:, :, 0] - one.volume[:, :1, 0]
    good = one.converged.all(axis=1)
    assert good.mean() > 0.9
    np.testing.assert_allclose(added[good], np.broadcast_to(one.loads[:, 0], added.shape)[good])


def test_a_spatial_arm_is_held_by_its_tendon() -> None:
    model = load("tendon-arm")
    (cable,) = model.threads
    path = model.equilibrium("0:3:0.5")
    held = load("tendon-arm", changes={f"actuators.{cable}.control": "length"})
    rest = held.engine.actuator_lengths(held.parameters, np.zeros(held.dof))[0]
    again = held.equilibrium((rest - path.length(cable)).tolist())
    assert again.stable.all()
    np.testing.assert_allclose(again.applied[:, 0], path.force, atol=1e-6)
    np.testing.assert_allclose(again.length(cable), path.length(cable), rtol=1e-10)
    # A cable that is not drawn holds the arm up; one that is let out too far would have to push.
    assert held.equilibrium([0.0]).applied[0, 0] > 0.0
    assert again.warnings == []
    pushed = held.equilibrium(["0 mm", "-10 mm"])
    assert pushed.applied[1, 0] < 0.0
    (warning,) = pushed.warnings
    assert warning.startswith(f'cable "{cable}" has a tension of -')
    assert warning.endswith("from -10 mm on below 0: a cable can only pull")


@pytest.mark.parametrize("length", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("force", [1e-6, 1.0, 1e6])
def test_scale_does_not_matter(length: float, force: float) -> None:
    text = TRUSS.replace('"20 N"', f'"{20 * force} N"')
    for size in ("10 cm", "5 mm", "9 cm", "2 cm", "2.2360679774997896 cm"):
        number, unit = size.split()
        text = text.replace(f'"{size}"', f'"{float(number) * length!r} {unit}"')
    text = text.replace('"4000 N/m"', f'"{4000 * force / length!r} N/m"')
    text = text.replace('"1e-3 N*m^2"', f'"{1e-3 * force * length**2!r} N*m^2"')
    drawn = np.linspace(0.0, 0.024, 9)
    path = Model(parse(text)).equilibrium((drawn * length).tolist())
    reference = Model(parse(TRUSS)).equilibrium(drawn.tolist())
    assert path.stable.all()
    np.testing.assert_allclose(path.q, reference.q, atol=1e-11)
    np.testing.assert_allclose(path.applied / force, reference.applied, atol=1e-8)
    assert path.iterations.sum() == reference.iterations.sum()


MILLILITRE = 'write a volume with its unit, such as "8 mL"'


@pytest.mark.parametrize(
    ("changes", "force", "message"),
    [
        (VOLUME, "0:60:5 kPa", f'force is "0:60:5 kPa", which is not a volume: {MILLILITRE}.'),
        (VOLUME, "0:8:1", f'force is "0:8:1", a number without a unit: {MILLILITRE}.'),
        (
            {},
            "0:8:1 mL",
            'force is "0:8:1 mL", which is not a pressure: write a pressure with its unit, such as '
            '"60 kPa".',
        ),
    ],
)
def test_units_that_do_not_fit(changes: dict[str, str], force: str, message: str) -> None:
    with pytest.raises(InputError) as raised:
        load(EXAMPLE, changes=changes).equilibrium(force)
    assert str(raised.value) == message


def test_more_than_there_is() -> None:
    syringe = load(EXAMPLE, changes=VOLUME)
    with pytest.raises(InputError, match=r'^"chamber" has -50 mL: its cavity holds .* mL\.$'):
        syringe.equilibrium("0:-50:10 mL")
    with pytest.raises(InputError, match=r'^"wire" has 120 mm: its path is 100 mm long\.$'):
        Model(parse(TRUSS)).equilibrium("0:120:10 mm")


@pytest.mark.parametrize(
    ("control", "message"),
    [
        ("volume", 'actuators.chamber.control is "volume": expected one of "force", "length"'),
        ("lenght", 'actuators.chamber.control is "lenght"'),
    ],
)
def test_unknown_controls(control: str, message: str) -> None:
    with pytest.raises(InputError) as raised:
        finger(control)
    assert message in str(raised.value)


def test_a_load_that_is_found_already() -> None:
    with pytest.raises(InputError, match='"air" is found already'):
        Model(parse(BALLOON)).equilibrium("0:8:1 mL", follow="arc-length")
    with pytest.raises(InputError, match=r"controlled by its volume: give evaluation"):
        load(EXAMPLE, changes=VOLUME).equilibrium()


def test_a_syringe_on_a_tube_that_does_not_stretch() -> None:
    # A taper is enough for a volume that bending changes by rounding, and 1e18 Pa were found.
    text = BALLOON.replace("extend_x", "bend_y").replace(
        '"10 mm"', '{ base = "10 mm", tip = "9.7 mm" }'
    )
    with pytest.raises(InputError, match='which no strain of "tube" changes: let it stretch'):
        Model(parse(text)).equilibrium("0:1:1 mL")
    assert (
        Model(parse(text.replace('"volume"', '"pressure"'))).equilibrium("0:1:1 kPa").stable.all()
    )


def test_a_wire_on_the_axis_of_a_rod_that_does_not_stretch() -> None:
    text = TRUSS.replace("extend_x", "bend_y")
    path = Model(parse(text)).equilibrium("0:1:1 mm")
    assert set(path.status) == {"invalid-design"}
