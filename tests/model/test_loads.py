"""Parsing of forces and loads."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.model.loads import forces, loads
from flexor.model.schema import ModelFile
from flexor.model.units import FORCE, LOAD_FACTOR, MOMENT, PRESSURE


@pytest.mark.parametrize(
    ("force", "expected"),
    [
        ([0, 1, 2.5], [0.0, 1.0, 2.5]),
        (np.array([0.0, 2.0]), [0.0, 2.0]),
        (["0 N", "500 mN", 1], [0.0, 0.5, 1.0]),
        ("0:5:1", [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]),
        ("0:3", [0.0, 1.0, 2.0, 3.0]),
        ("1 N:2 N:0.5 N", [1.0, 1.5, 2.0]),
        ("0:5:2", [0.0, 2.0, 4.0, 5.0]),
        ("5:0:2", [5.0, 3.0, 1.0, 0.0]),
        ("3:3:1", [3.0]),
        ("0, 1, 2 N", [0.0, 1.0, 2.0]),
        ("5", [5.0]),
        (5, [5.0]),
        ([2, 2], [2.0, 2.0]),
        ([-1, 0], [-1.0, 0.0]),
    ],
)
def test_forces(force: object, expected: list[float]) -> None:
    assert forces(force).tolist() == expected  # type: ignore[arg-type]


def test_fine_steps_include_the_coarse_ones_exactly() -> None:
    assert set(forces("0:5:1")) <= set(forces("0:5:0.1"))
    assert len(forces("0:5:0.1")) == 51


@pytest.mark.parametrize(
    ("pressure", "expected"),
    [
        ("0:60:20 kPa", [0.0, 2e4, 4e4, 6e4]),
        ("0 kPa:0.3 kPa:0.1 kPa", [0.0, 100.0, 200.0, 300.0]),
        ("0:0.1:0.05 bar", [0.0, 5e3, 1e4]),
        (["10 kPa", 2e4], [1e4, 2e4]),
        ("-10:10:10 kPa, 5 kPa", [-1e4, 0.0, 1e4, 5e3]),
    ],
)
def test_pressures(pressure: object, expected: list[float]) -> None:
    assert forces(pressure, PRESSURE).tolist() == expected  # type: ignore[arg-type]


PASCAL = 'write a pressure with its unit, such as "60 kPa"'


@pytest.mark.parametrize(
    ("pressure", "message"),
    [
        ("5 N", f'force is "5 N", which is not a pressure: {PASCAL}.'),
        ("0:5:1 N", f'force is "0:5:1 N", which is not a pressure: {PASCAL}.'),
        ("0:5:1", f'force is "0:5:1", a number without a unit: {PASCAL}.'),
        ("60", f'force is "60", a number without a unit: {PASCAL}.'),
        ("0:x:1 kPa", 'force is "0:x:1 kPa": write start:stop:step in Pa, such as 0:60:5 kPa.'),
        (["5 kPa", None], "force[1] is of type NoneType: expected a pressure in Pa."),
    ],
)
def test_bad_pressures(pressure: object, message: str) -> None:
    with pytest.raises(InputError) as raised:
        forces(pressure, PRESSURE)  # type: ignore[arg-type]
    assert str(raised.value) == message


STEP = "the step must be greater than zero, also where the load falls."
NEWTON = 'write a force with its unit, such as "5 N"'


@pytest.mark.parametrize(
    ("force", "message"),
    [
        (
            [],
            "force is an empty list: give at least one force, such as 0:5:1.",
        ),
        ([0, float("nan")], "force[1] is nan: it must be a finite number."),
        ([float("inf")], "force[0] is inf: it must be a finite number."),
        (["0 N", "3 kg"], f'force[1] is "3 kg", which is not a force: {NEWTON}.'),
        ([None], "force[0] is of type NoneType: expected a force in N."),
        ([True], "force[0] is true: expected a force in N."),
        ("", f'force is "", which is not a force: {NEWTON}.'),
        ("five", f'force is "five", which is not a force: {NEWTON}.'),
        ("0:5:0", f'force is "0:5:0": {STEP}'),
        ("0:5:-1", f'force is "0:5:-1": {STEP}'),
        ("0:5:x", 'force is "0:5:x": write start:stop:step in N, such as 0:5:1.'),
        ("0:nan:1", 'force is "0:nan:1": write start:stop:step in N, such as 0:5:1.'),
        ("0:5:1:2", 'force is "0:5:1:2": write start:stop:step in N, such as 0:5:1.'),
        ("0:5:1e-9", 'force is "0:5:1e-9": a path has at most 1,000,000 steps.'),
    ],
)
def test_bad_forces(force: object, message: str) -> None:
    with pytest.raises(InputError) as caught:
        forces(force)  # type: ignore[arg-type]
    assert str(caught.value) == message


def test_the_load_of_a_wrench_is_what_its_vector_is_of() -> None:
    model = flexor.load(
        ModelFile.model_validate(
            {
                "name": "lever",
                "bodies": {
                    "lever": {
                        "kind": "link",
                        "length": "4 cm",
                        "radius": "1 cm",
                        "joint": {"kind": "revolute", "stiffness": "1 N*m/rad"},
                    }
                },
                "wrenches": {
                    "pull": {"body": "lever", "at": "tip", "force": {"z": "-1 N"}, "input": True},
                    "turn": {"body": "lever", "at": "tip", "moment": {"y": "1 N*m"}, "input": True},
                    "both": {"body": "lever", "at": "tip", "force": {"z": "-2 N"}, "input": True},
                },
            }
        )
    )
    assert list(model.input_dimensions.values()) == [FORCE, MOMENT, LOAD_FACTOR]
    assert [model.show_load(2.0, index=i) for i in range(3)] == ["2 N", "2 N*m", "load factor 2"]
    found = loads({"pull": "0:200:100 mN", "turn": "5 N*mm", "both": 0.5}, model.input_dimensions)
    assert found.tolist() == [[0.0, 0.005, 0.5], [0.1, 0.005, 0.5], [0.2, 0.005, 0.5]]
    with pytest.raises(InputError, match="not a load factor: write a load factor, such as 5"):
        loads({"both": "3 N"}, model.input_dimensions)


def test_a_single_input_accepts_a_list() -> None:
    assert loads([0, 1], {"chamber": FORCE}).tolist() == [[0.0], [1.0]]


def test_several_inputs_are_named_and_single_values_held() -> None:
    result = loads({"b": "0:2:1", "a": 3}, dict.fromkeys("abc", FORCE))
    assert result.tolist() == [[3.0, 0.0, 0.0], [3.0, 1.0, 0.0], [3.0, 2.0, 0.0]]


def test_a_model_without_inputs_accepts_only_zeros() -> None:
    assert loads([0, 0], {}).shape == (2, 0)
    with pytest.raises(InputError, match="the model has no actuator: leave it out"):
        loads([0, 1], {})


@pytest.mark.parametrize(
    ("force", "message"),
    [
        (
            [0, 1],
            'force must name its input, one of "left", "right": use a dict in Python, and '
            "left=0:5:1 on the command line.",
        ),
        (
            {"lfet": [0, 1]},
            'unknown input "lfet" (did you mean "left"?): expected one of "left", "right".',
        ),
        (
            {"left": [0, 1, 2], "right": [0, 1]},
            'force has 2 steps for "right" and 3 for another input: give the same number for '
            "each, or one to hold constant.",
        ),
    ],
)
def test_bad_loads(force: object, message: str) -> None:
    with pytest.raises(InputError) as caught:
        loads(force, {"left": FORCE, "right": FORCE})  # type: ignore[arg-type]
    assert str(caught.value) == message
