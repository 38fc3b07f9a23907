"""Contact with round cones: what is described, what it is in limits, and its derivatives."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from flexor.design import parameter_set
from flexor.model import Model, load, parse
from flexor.model.lowering import lower
from flexor.plot.reading import read_scene

SOLID = {"skin.shape": "round-cones"}
PLATE = """
name = "plate"
planar = true

[bodies.suit]
kind = "rod"
length = "10 cm"
radius = "8 mm"
young_modulus = "1 MPa"
poisson_ratio = 0.5
strain = {{ bend_y = "nodal_linear", extend_x = "nodal_linear" }}
elements = {elements}
gauss_points = 2
joint = {{ kind = "prismatic", axis = "z", stiffness = "0 N/m" }}
placement = {{ z = "18 mm" }}

[bodies.plate]
kind = "link"
length = "20 cm"
radius = "1 cm"
placement = {{ x = "-5 cm" }}

[spheres.suit]
bodies = ["suit"]
[spheres.plate]
bodies = ["plate"]

[contacts.skin]
first = "suit"
second = "plate"
shape = "round-cones"
stiffness_per_length = "20 kPa"

[wrenches.push]
body = "suit"
at = 0.5
force = {{ z = "-0.1 N" }}
input = true
"""


@pytest.fixture(scope="module")
def finger() -> Model:
    return load("finger", "calibrated", changes=SOLID)


def test_the_finger_is_one_chain_of_four(finger: Model) -> None:
    described = lower(finger.file)
    contact, groups = described["contacts"][0], {g["name"]: g for g in described["spheres"]}
    assert [s["station"] for s in groups["finger"]["spheres"]] == 4 * [
        {"fraction": 0.0},
        {"fraction": 1.0},
    ]
    assert contact["cones"] == [
        {"ends": [2 * link, 2 * link + 1], "joined": link > 0} for link in range(4)
    ]
    assert "weights" not in contact
    assert finger.sphere_groups == {"exosuit": 42, "finger": 8}


def test_a_rod_is_a_chain_of_its_sample_points() -> None:
    described = lower(
        load("finger", "calibrated", changes={**SOLID, "skin.second": "exosuit"}).file
    )
    cones = described["contacts"][0]["cones"]
    assert [cone["ends"] for cone in cones] == [[k, k + 1] for k in range(1, 41)]
    assert [cone["joined"] for cone in cones] == [False] + 39 * [True]


def test_the_shares_of_a_length_make_up_the_whole() -> None:
    (contact,) = lower(parse(PLATE.format(elements=4)))["contacts"]
    weights = contact["weights"]
    gauss = 0.25 * (0.5 - 0.5 / math.sqrt(3.0))  # the first Gauss point of the first element
    assert weights[:2] == pytest.approx([0.0, 0.5 * gauss])
    assert sum(weights) == pytest.approx(1.0)


@pytest.mark.parametrize("elements", [2, 6])
def test_a_rod_on_a_plate_sinks_in_by_force_over_stiffness_and_length(elements: int) -> None:
    text = PLATE.format(elements=elements)
    # Stiff enough to stay straight, so that it sinks in alike everywhere.
    model = Model(parse(text.replace("1 MPa", "1000 GPa")))
    # Measured against such stiffness, the usual tolerance would be nanometres.
    path = model.equilibrium([0, 1, 3], tolerance=1e-12)
    slide = model.engine.coordinates.index("suit.d")
    for step, force in enumerate((0.0, 0.1, 0.3)):
        assert path.q[step, slide] == pytest.approx(-force / (20e3 * 0.1), rel=1e-5, abs=1e-12)
        assert path.contact_forces(step).force.sum(axis=0)[2] == pytest.approx(force)


def test_finer_rods_come_to_the_same_end() -> None:
    depth = []
    for elements in (4, 8, 16, 32):
        path = Model(parse(PLATE.format(elements=elements))).equilibrium([2])
        depth.append(path.frames()["suit"][elements // 2 * 3][2, 3])
    steps = np.abs(np.diff(depth))
    assert steps[-1] < 0.3 * steps[-2] < 0.3 * steps[-3]


def test_forces_are_those_on_the_joints(finger: Model) -> None:
    path = finger.equilibrium([5])
    found = path.contact_forces()
    assert found.cone.all()
    # The finger feels nothing else, so each joint carries the moment of what acts beyond it.
    frames = path.frames()
    for link, stiffness in (("ph_3", 0.02), ("ph_2", 0.03), ("ph_1", 0.04)):
        x, z = frames[link][0][[0, 2], 3]
        beyond = found.second >= 42 + 2 * int(link[-1]) - 2
        arm, push = found.point[beyond] - [x, 0.0, z], -found.force[beyond]
        moment = (arm[:, 2] * push[:, 0] - arm[:, 0] * push[:, 2]).sum()
        angle = path.joint_angles[-1, int(link[-1]) - 1]
        assert moment == pytest.approx(stiffness * angle, rel=1e-6)


def test_an_arrow_for_every_place(finger: Model) -> None:
    path = finger.equilibrium([5])
    found = path.contact_forces()
    arrows = read_scene(path).contact_arrows
    assert len(arrows) == len(set(found.first.tolist())) >= 2
    total = sum((arrow.force for arrow in arrows), np.zeros(3))
    np.testing.assert_allclose(total, -found.force.sum(axis=0), atol=1e-12)


@pytest.mark.parametrize("per_length", [False, True])
def test_gradients_are_those_of_differences(per_length: bool) -> None:
    model = load("finger", "calibrated", changes=SOLID)
    if per_length:
        text = model.file.to_document()
        text.pop("variants")
        text.pop("use")
        text["contacts"]["skin"].pop("stiffness")
        text["contacts"]["skin"]["stiffness_per_length"] = "32 kPa"
        model = Model(type(model.file).model_validate(text))
    chosen = parameter_set("L+R01", model.design)
    span = chosen.upper - chosen.lower
    p = chosen.lower + span * np.random.default_rng(5).uniform(0.1, 0.9, (12, chosen.size))

    def last(p: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        batch = model.evaluate(chosen.geometry(p, model.X), tolerance=1e-12)
        outputs = np.concatenate((batch.joint_angles[:, -1], batch.tip_force[:, -1:]), axis=1)
        return outputs, batch.event_count

    here = model.evaluate(chosen.geometry(p, model.X), gradient=True, tolerance=1e-12)
    assert here.regularity is not None
    exact = here.chained(chosen.jacobian(p, model.X)) * span
    regular = here.regularity == "regular"
    assert regular.sum() >= 6
    assert (here.tip_force[regular, -1] > 0.0).any()
    step = 1e-5
    for k in range(chosen.size):
        shift = step * span * np.eye(chosen.size)[k]
        (up, snaps), (down, others) = last(p + shift), last(p - shift)
        alike = regular & (snaps == 0) & (others == 0)
        assert alike.sum() >= 6
        difference = (up - down) / (2.0 * step)
        size = np.abs(exact).max(axis=(1, 2))[:, None]
        error = (np.abs(difference - exact[:, :, k]) / size)[alike]
        # A kink of contact between the two designs spoils a difference, not the derivative.
        assert np.median(error.max(axis=1)) < 1e-6
        assert np.mean(error.max(axis=1) < 1e-5) > 0.8
