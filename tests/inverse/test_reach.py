"""Loads that bring observables to given values, against closed forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from flexor.errors import InputError
from flexor.inverse import reach, targets
from flexor.model import Model, load, parse
from flexor.observables import observables

EXAMPLES = Path(__file__).parents[2] / "examples"
PROXIMAL, DISTAL = 0.04, 0.03  # N·m/rad

CHAIN = f"""
name = "chain"
planar = true

[bodies.near]
kind = "link"
length = "4 cm"
radius = "1 cm"
joint = {{ kind = "revolute", stiffness = "{PROXIMAL} N*m/rad" }}

[bodies.far]
kind = "link"
parent = "near"
length = "3 cm"
radius = "1 cm"
joint = {{ kind = "revolute", stiffness = "{DISTAL} N*m/rad" }}

[wrenches]
first = {{ body = "near", at = "tip", moment = {{ y = "1 N*m" }}, input = true }}
second = {{ body = "far", at = "tip", moment = {{ y = "1 N*m" }}, input = true }}
"""

TRUSS = """
name = "truss"
planar = true

[bodies.node]
kind = "link"
length = "1 mm"
radius = "1 mm"
joint = { kind = "prismatic", axis = "z", stiffness = "0 N/m" }
placement = { z = "2 cm", x = "-1 mm" }

[springs.left]
stiffness = "1000 N/m"
rest_length = "0.10198039027185571 m"
first = { body = "node", at = "tip" }
second = { world = { x = "-10 cm" } }

[springs.right]
stiffness = "1000 N/m"
rest_length = "0.10198039027185571 m"
first = { body = "node", at = "tip" }
second = { world = { x = "10 cm" } }

[wrenches.push]
body = "node"
at = "tip"
input = true
force = { z = "-1 N" }
"""
WIDE = {"first": "-1:1:0.5", "second": "-1:1:0.5"}


def chain() -> Model:
    return Model(parse(CHAIN))


def test_moments_that_hold_two_hinges_at_given_angles() -> None:
    found = reach(chain(), "near = 40 deg, far = -30 deg", WIDE)
    near, far = np.radians([40.0, -30.0])
    assert found.reached
    assert not found.reason
    # The second moment turns both hinges.
    assert found.loads["second"] == pytest.approx(DISTAL * far, rel=1e-7)
    assert found.loads["first"] == pytest.approx(PROXIMAL * near - DISTAL * far, rel=1e-7)
    assert found.path[-1].joint_angles == pytest.approx([near, far], abs=1e-7)


def test_fewer_targets_than_loads() -> None:
    found = reach(chain(), {"bending": "50 deg"}, WIDE)
    assert found.reached
    assert found.path[-1].joint_angles.sum() == pytest.approx(np.radians(50.0), abs=1e-7)


def test_a_load_given_as_one_value_is_held() -> None:
    found = reach(chain(), "far = 20 deg", {"first": "0.01 N*m", "second": "0:1:0.5"})
    assert found.reached
    assert found.loads["first"] == 0.01
    assert found.loads["second"] == pytest.approx(DISTAL * np.radians(20.0), rel=1e-7)


def truss_force(z: float) -> float:
    """Return the force that holds the apex at a height."""
    length = np.hypot(0.1, z)
    return float(2e3 * (0.10198039027185571 - length) * z / length)


def test_a_value_between_the_ends_of_a_snap_is_not_reached() -> None:
    model = Model(parse(TRUSS))
    before = reach(model, "node = -5 mm", "0:0.6:0.1")
    assert before.reached
    assert before.loads["push"] == pytest.approx(truss_force(0.015), rel=1e-6)

    between = reach(model, "node = -20 mm", "0:0.6:0.1")  # flat: an unstable equilibrium
    assert not between.reached
    assert "snap" in between.reason
    assert str(between).startswith(
        "NOT REACHED: angle.node = -20 mm. The branch ends in a snap at 0.30"
    )


def test_values_that_change_late_or_come_back_are_reached() -> None:
    """A strap that is slack at first, and an efficiency, which has no value without pressure."""
    model = load("pneumatic-finger")
    for name, value in (("strap-force.middle", 0.01), ("efficiency", 0.05)):
        found = reach(model, {name: value if name == "efficiency" else f"{value} N"})
        assert found.reached and 0.0 < found.loads["chamber"] < 60e3
        again = model.equilibrium([0.0, found.loads["chamber"]])
        values = observables(model)[name].values(again.as_batch)
        assert values[0, -1] == pytest.approx(value, rel=1e-6)
    slack = reach(model, "strap-force.middle = 0.1 N", "0:8:4 kPa")
    assert not slack.reached and "chamber at 8 kPa" in slack.reason


def test_a_value_beyond_a_snap_is_reached() -> None:
    model = Model(parse(TRUSS))
    beyond = reach(model, "node = -45 mm", "0:0.6:0.1")
    assert beyond.reached
    assert [event.kind for event in beyond.path.events] == ["snap"]
    assert beyond.loads["push"] == pytest.approx(truss_force(-0.025), rel=1e-6)


# Its finger does not move at all under the first few kilopascals.
@pytest.mark.parametrize("angle", [95, 98, 100])
def test_loads_stay_within_their_range(angle: int) -> None:
    model = load(EXAMPLES / "pneumatic-finger.toml")
    found = reach(model, f"bending = {angle} deg")
    assert not found.reached
    assert found.loads["chamber"] == pytest.approx(60e3)
    assert "limits (chamber at 60 kPa)" in found.reason
    assert found.to_dict()["reached"] is False


def test_pressure_for_a_posture_of_the_example() -> None:
    model = load(EXAMPLES / "pneumatic-finger.toml")
    found = reach(model, {"bending": "45 deg"})
    assert found.reached
    # Under the pressure found, followed afresh.
    bent = model.equilibrium([0.0, found.loads["chamber"]])
    assert np.degrees(bent.joint_angles[-1].sum()) == pytest.approx(45.0, abs=1e-5)


@pytest.mark.parametrize(
    ("to", "loads", "message"),
    [
        ("", WIDE, 'give key=value, such as "ph_1=40 deg"'),
        ("near", WIDE, 'give key=value, such as "ph_1=40 deg"'),
        ("near = 40", WIDE, "a number without a unit"),
        ("near = 4 cm", WIDE, "reach: near"),
        ("nearr = 40 deg", WIDE, '"near"'),
        ("near = 40 deg, near = 30 deg", WIDE, 'sets "near" twice'),
        ("near = 40 deg, angle.near = 30 deg", WIDE, 'two values for "angle.near"'),
        ("near = 1 deg, far = 2 deg", {"first": "0:1:0.5"}, "2 targets, but only 1 load changes"),
        ({}, WIDE, "no target"),
    ],
)
def test_bad_input(to: str | dict[str, str], loads: dict[str, str], message: str) -> None:
    with pytest.raises(InputError, match=message.replace("(", r"\(")):
        reach(chain(), to, loads)


def test_a_model_without_loads() -> None:
    model = Model(parse(CHAIN.replace(", input = true", "")))
    with pytest.raises(InputError, match="no actuator"):
        reach(model, "near = 1 deg")


def test_targets_are_in_si() -> None:
    (found,) = targets("near = 90 deg", chain())
    assert found.value == pytest.approx(np.pi / 2.0)
    assert str(found) == "angle.near = 90 deg"
