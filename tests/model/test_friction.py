"""Friction in models: what is said, kept, continued, refused, and the same in any position."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path as FilePath

import numpy as np
import pytest

import flexor
from flexor.design import variables
from flexor.errors import InputError
from flexor.model import Model, parse, why_stalled
from flexor.model.derivatives import differentiate, last_step

SLEDGE = """
name = "sledge"
planar = true

[bodies.carriage]
kind = "link"
length = "1 cm"
radius = "1 cm"
placement = { z = "1 cm" }
joint = { kind = "prismatic", axis = "z", stiffness = "1 N/m" }

[bodies.block]
kind = "link"
parent = "carriage"
length = "1 cm"
radius = "1 cm"
joint = { kind = "prismatic", axis = "x", stiffness = "300 N/m" }

[spheres.foot]
points = [{ body = "block", at = "base" }]

[obstacles.floor]
kind = "half-space"
normal = "z"
spheres = ["foot"]
stiffness = "20 kN/m"
friction = 0.4

[wrenches.press]
body = "block"
at = "base"
force = { z = "-1 N" }
input = true

[wrenches.pull]
body = "block"
at = "base"
force = { x = "1 N" }
input = true
"""
LOADS = {"press": [0.0, 5.0, 5.0, 5.0, 5.0, 5.0], "pull": [0.0, 0.0, 1.0, 4.0, 3.0, -1.0]}
SPATIAL = SLEDGE.replace("planar = true", "planar = false")


@pytest.mark.parametrize("text", [SLEDGE, SPATIAL])
def test_what_is_said_of_a_block_that_slides(text: str) -> None:
    path = Model(parse(text)).equilibrium(LOADS)
    assert path.stable.all()
    sliding = [path.friction_forces(step).slides.tolist() for step in range(1, 6)]
    assert sliding == [[False], [False], [True], [False], [True]]
    found = path.friction_forces(3)
    np.testing.assert_allclose(found.force, [[-2.0, 0.0, 0.0]], rtol=2e-4)
    np.testing.assert_allclose(found.limit, [2.0], rtol=2e-4)
    np.testing.assert_allclose(found.slip, [[2.0 / (2e4 / 1.5), 0.0, 0.0]], rtol=2e-4)
    assert found.name.tolist() == ["floor"]
    assert path.q[3, 1] == pytest.approx(2.0 / 300.0, rel=2e-4)
    told = path.to_dict()
    assert told["friction"][0] == []
    assert told["friction"][3][0]["slides"] is True
    assert told["friction"][3][0]["name"] == "floor"
    assert told["dissipated"] == path.dissipated.tolist()
    assert path.dissipated[3] > 0.0


def test_a_path_goes_on_from_a_state_or_a_file_with_its_slips(tmp_path: FilePath) -> None:
    model = Model(parse(SLEDGE))
    whole = model.equilibrium(LOADS)
    first = model.equilibrium({name: loads[:4] for name, loads in LOADS.items()})
    rest = {name: loads[3:] for name, loads in LOADS.items()}
    file = tmp_path / "slid.json"
    file.write_text(json.dumps(first.to_dict()), encoding="utf-8")
    for start in (first, first[-1], str(file)):
        path = model.equilibrium(rest, start=start)
        np.testing.assert_allclose(path.q, whole.q[3:], rtol=1e-9, atol=1e-15)
        # Only in the first state is there nothing that would have slid further.
        assert path.friction_forces(2).slides.all()


def test_what_only_friction_holds_is_found_where_press_and_pull_grow_together() -> None:
    loose = Model(parse(SLEDGE.replace('stiffness = "300 N/m"', 'stiffness = "0 N/m"')))
    path = loose.equilibrium({"press": [0.0, 0.5, 5.0, 5.0], "pull": [0.0, 0.0, 1.5, 2.5]})
    # 1.5 N are more than the 0.2 N at the beginning of the step, but less than the 2 N at its end.
    assert path.converged.tolist() == [True, True, True, False]
    assert path.q[2, 1] == pytest.approx(1.5 / (2e4 / 1.5), rel=1e-6)
    assert not path.events


def test_a_load_that_is_held_changes_nothing() -> None:
    held = {name: loads[:5] + [loads[4]] * 50 for name, loads in LOADS.items()}
    path = Model(parse(SLEDGE)).equilibrium(held)
    assert (path.q[4:] == path.q[4]).all()
    assert (path.dissipated[4:] == path.dissipated[4]).all()


def test_friction_is_the_same_in_any_position() -> None:
    turn = "rotation = { x = '31 deg', y = '-47 deg', z = '68 deg' }"
    # A link that is turned carries everything; the floor is an obstacle of it.
    carrier = f"""
[bodies.ground]
kind = "link"
length = "1 mm"
radius = "1 mm"
placement = {{ x = "3 cm", y = "-2 cm", z = "5 cm", {turn} }}
joint = {{ kind = "fixed" }}
"""
    text = SPATIAL.replace("[bodies.carriage]", f"{carrier}\n[bodies.carriage]\nparent = 'ground'")
    text = text.replace('normal = "z"', 'normal = "z"\npoint = { body = "ground", at = "base" }')
    text = text.replace('at = "base"\nforce', 'at = "base"\nframe = "body"\nforce')
    plain = Model(parse(SPATIAL)).equilibrium(LOADS)
    turned = Model(parse(text)).equilibrium(LOADS)
    np.testing.assert_allclose(turned.q, plain.q, rtol=1e-8, atol=1e-13)
    np.testing.assert_allclose(turned.dissipated, plain.dissipated, rtol=1e-8, atol=1e-15)
    axes = turned.frames(3)["ground"][0, :3, :3]
    np.testing.assert_allclose(
        turned.friction_forces(3).force @ axes, plain.friction_forces(3).force, atol=1e-8
    )
    assert not np.allclose(turned.frames(3)["ground"][0, :3, 3], np.zeros(3))


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            "friction = 0.4",
            "friction = -0.4",
            "floor.friction is -0.4: it must be at least 0",
        ),
        ("friction = 0.4", 'friction = "a"', "obstacles.floor.friction is"),
        (
            "friction = 0.4",
            "stiffness_ratio = 0.5",
            "floor.stiffness_ratio is given without",
        ),
        (
            "friction = 0.4",
            "friction = 0.4\nstiffness_ratio = 0.0",
            "obstacles.floor.stiffness_ratio is 0.0",
        ),
    ],
)
def test_what_is_no_friction_is_said_in_a_sentence(old: str, new: str, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        parse(SLEDGE.replace(old, new))
    assert sentence in str(caught.value)
    assert str(caught.value).count("\n") == 0


def test_friction_of_a_rod_without_skin_is_refused() -> None:
    text = parse(SLEDGE).to_toml() + (
        "\n[bodies.rod]\nkind = 'rod'\nlength = '1 cm'\nradius = '1 mm'\nfriction = 0.1\n"
        "young_modulus = '1 MPa'\npoisson_ratio = 0.5\ngauss_points = 2\n"
        "strain = { bend_y = 'nodal_linear' }\n"
    )
    with pytest.raises(InputError, match=r"bodies\.rod\.friction is given without a skin"):
        parse(text)


def test_what_friction_does_not_have_is_refused() -> None:
    model = Model(parse(SLEDGE))
    path = model.equilibrium({"press": [0.0, 5.0], "pull": 0.0})
    with pytest.raises(InputError, match="derivatives need a path from its first step on"):
        part = path.as_batch[:, 1:]
        differentiate(part, last_step(part), np.arange(1))
    with pytest.raises(InputError, match="depends on the order of the loads"):
        model.equilibrium({"press": [0.0, 5.0], "pull": 0.0}, follow="arc-length")


def test_skins_rub() -> None:
    changes = {"bodies.exosuit.friction": 0.3}
    smooth, rough = (
        flexor.load("pneumatic-finger"),
        flexor.load("pneumatic-finger", changes=changes),
    )
    loads = [0.0, 6e3, 12e3, 18e3, 24e3]
    paths = smooth.equilibrium(loads), rough.equilibrium([*loads, 18e3, 12e3])
    assert paths[1].converged.all()
    rubbing = paths[1].friction_forces(4)
    assert set(rubbing.name) == {"exosuit"}
    assert (np.linalg.norm(rubbing.force, axis=1) <= rubbing.limit * (1.0 + 1e-6)).all()
    assert rubbing.slides.any()
    bend = [path.joint_angles[:, :].sum(axis=1) for path in paths]
    # Friction resists on the way up and on the way down.
    assert bend[1][4] < bend[0][4]
    assert bend[1][5] > bend[0][3]
    assert (np.diff(paths[1].dissipated) > -1e-15).all()


def test_a_search_varies_lengths_and_the_coefficient_with_derivatives() -> None:
    rough = flexor.load("pneumatic-finger", changes={"bodies.exosuit.friction": 0.3})
    varied = {"exosuit.length": ("9 cm", "11 cm"), "exosuit.friction": (0.1, 0.5)}
    study = flexor.optimize(
        rough, varied, "maximise range-of-motion", budget=8, force="0:20:10 kPa"
    )
    assert study.best.value <= study.start.value
    assert study.best.sensitivity.regularity == "regular"


def test_skins_rub_under_volumes_and_on_any_number_of_threads() -> None:
    changes = {"bodies.exosuit.friction": 0.4, "actuators.chamber.control": "volume"}
    model = flexor.load("pneumatic-finger", changes=changes)
    path = model.equilibrium("0:4:0.5 mL")
    assert path.stable.all() and path.friction_forces().slides.any()
    smooth = flexor.load("pneumatic-finger", changes={"actuators.chamber.control": "volume"})
    assert path.joint_angles[-1].sum() < smooth.equilibrium("0:4:0.5 mL").joint_angles[-1].sum()
    lengths = {"exosuit.length": ("9 cm", "11 cm")}
    rough = flexor.load("pneumatic-finger", changes={"bodies.exosuit.friction": 0.4})
    chosen = variables(lengths, rough, "lengths")
    designs, _ = chosen.designs(np.linspace(0.09, 0.11, 40)[:, None], rough)
    one, two = (rough.evaluate(designs, "0:30:10 kPa", threads) for threads in (1, 2))
    assert one.converged.all() and (one.q == two.q).all()
    assert (one.dissipated == two.dissipated).all()


def test_friction_balances_the_other_forces() -> None:
    """The residual without friction is the work of the friction on differenced motions."""
    model = flexor.load("capstan")
    path = model.equilibrium([0.0, 0.5, 1.0, 2.0, 1.5])
    rubbing, q, engine = path.friction_forces(), path.q[-1], model.engine
    assert rubbing.slides.any() and not rubbing.slides.all()
    start, _ = engine.body_frames["strip"]
    first, _ = engine.sphere_groups["strip"]
    # The first sphere is at the joint, where the first sample point is as well.
    at = start + np.maximum(rubbing.sphere - first - 1, 0)

    def places(q: np.ndarray) -> np.ndarray:
        pose = engine.frames(path.parameters, q)[at]
        return np.einsum("mij,mj->mi", pose[:, :3, :3], local) + pose[:, :3, 3]

    pose = engine.frames(path.parameters, q)[at]
    local = np.einsum("mji,mj->mi", pose[:, :3, :3], rubbing.place - pose[:, :3, 3])
    h = 1e-6
    work = [
        np.sum(rubbing.force * (places(q + step) - places(q - step))) / (2.0 * h)
        for step in h * np.eye(len(q))
    ]
    other = engine.residual(path.parameters, q, path.loads[-1])
    assert np.abs(other).max() > 1e-3
    np.testing.assert_allclose(other, work, atol=1e-8 * np.abs(other).max() + 1e-9)


@pytest.mark.parametrize("pull", [0.5, 1.0])
def test_a_strip_that_comes_to_rest_on_a_post_does_not_snap(pull: float) -> None:
    path = flexor.load("capstan").equilibrium([0.0, pull])
    assert path.converged.all()
    assert not path.events


def test_a_contact_that_begins_within_a_step_is_resisted_from_there() -> None:
    """A block 1 mm above the floor falls and is pulled in one step."""
    text = SLEDGE.replace('placement = { z = "1 cm" }', 'placement = { z = "11 mm" }')
    path = Model(parse(text)).equilibrium({"press": [0.0, 5.0], "pull": [0.0, 1.0]})
    z, x = path.q[1]
    assert z == pytest.approx(-1e-3 - (5.0 - 1e-3) / 2e4, rel=1e-4)
    # Of the straight way, what lies below the floor is slip.
    depth = -z - 1e-3
    stiffness = 2e4 / 1.5 * depth / -z
    assert x == pytest.approx(1.0 / (300.0 + stiffness), rel=1e-9)


@pytest.mark.parametrize("slope", [0.3, 0.39])
def test_a_block_that_just_touches_a_slope_stays_on_it(slope: float) -> None:
    loose = SLEDGE.replace('stiffness = "300 N/m"', 'stiffness = "0 N/m"')
    path = Model(parse(loose)).equilibrium({"press": [5.0], "pull": [5.0 * slope]})
    assert path.converged.all()
    assert path.q[-1, 1] == pytest.approx(5.0 * slope / (2e4 / 1.5), rel=1e-3)


def test_energy_balances_through_skins_whose_stiffness_changes() -> None:
    model = flexor.load("pneumatic-finger", changes={"bodies.exosuit.friction": 0.5})

    def gap(steps: int) -> float:
        up = np.linspace(0.0, 24e3, steps + 1)
        loads = np.concatenate([up, up[-2::-1]])
        path = model.equilibrium(loads)
        volume = path.volume[:, 0]
        work = float(np.sum(0.5 * (loads[1:] + loads[:-1]) * np.diff(volume)))
        stored = path.energy + loads * volume
        return abs(work - float(stored[-1] - stored[0] + path.dissipated[-1])) / work

    gaps = gap(8), gap(16)
    assert gaps[0] < 0.15
    assert gaps[1] < 0.6 * gaps[0]


def test_without_friction_nothing_is_dissipated() -> None:
    path = Model(parse(SLEDGE.replace("friction = 0.4", ""))).equilibrium(LOADS)
    assert (path.dissipated == 0.0).all()
    assert "dissipated" not in path.to_dict()


WEDGE = """
name = "wedge"
planar = true
[bodies.strut]
kind = "link"
length = "1 cm"
radius = "1 cm"
placement = {{ z = "1 cm" }}
joint = {{ kind = "prismatic", axis = [{along}, 0.0, {across}], stiffness = "1 N/m" }}
[spheres.foot]
points = [{{ body = "strut", at = "base" }}]
[obstacles.floor]
kind = "half-space"
normal = "z"
spheres = ["foot"]
stiffness = "20 kN/m"
friction = {friction}
[wrenches.push]
body = "strut"
at = "base"
force = {{ x = "{along} N", z = "{across} N" }}
input = true
"""


@pytest.mark.parametrize("friction", [0.2, 0.4, 0.8])
@pytest.mark.parametrize("feedback", [0.5, 0.95, 1.1, 3.0])
def test_a_strut_slides_under_its_own_normal_force_and_jams(
    friction: float, feedback: float
) -> None:
    """It is pushed at an angle φ from the normal; ``feedback`` is μ tan φ."""
    tan = feedback / friction
    cos = 1.0 / np.hypot(1.0, tan)
    sin = tan * cos
    model = Model(parse(WEDGE.format(along=sin, across=-cos, friction=friction)))
    up = np.arange(0.0, 10.5)
    path = model.equilibrium(np.concatenate([up, up[-2::-1], -np.linspace(0.5, 40.0, 80)]))
    assert path.stable.all()
    # F = N (cos φ + μ sin φ) where it slides, with k_t = 2/3 k and the soft spring where it sticks.
    rubs = min(friction, 2.0 / 3.0 * tan)
    x = 10.0 / (2e4 * cos * (cos + rubs * sin) + 1.0)
    assert path.q[10, 0] == pytest.approx(x, rel=1e-9)
    jams = feedback > 1.0 and rubs == friction
    assert (path.q[20, 0] > 0.05 * x) == jams
    # What jams gives way at a pull; what does not slides out.
    assert [event.kind for event in path.events] == (["snap"] if jams else [])
    for event in path.events:
        before, after = event.step - 1, event.step
        assert path.q[before, 0] > 0.0 > path.q[after, 0]


def test_a_step_in_which_friction_does_not_settle_says_so() -> None:
    """Its residual is small: what it lacks are normal forces that stay as they are."""
    path = Model(parse(SLEDGE)).equilibrium(LOADS)
    status = path.status.copy()
    status[3] = "stalled"
    assert "did not settle" in why_stalled(replace(path, status=status))
