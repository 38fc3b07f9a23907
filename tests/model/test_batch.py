"""Batches are put together from parts without a trace."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import flexor
from flexor.design import parameter_set
from flexor.model import Batch, Model, follow


@pytest.fixture(scope="module")
def finger() -> Model:
    return flexor.load("finger", "calibrated")


def random_batch(model: Model, count: int) -> Batch:
    chosen = parameter_set("L+R01", model.design)
    unit = np.random.default_rng(4).uniform(size=(count, chosen.size))
    designs = chosen.lower + unit * (chosen.upper - chosen.lower)
    return model.evaluate(chosen.geometry(designs, model.X))


@pytest.mark.parametrize("part", [1, 7, 40])
def test_parts_leave_no_trace(finger: Model, monkeypatch: pytest.MonkeyPatch, part: int) -> None:
    whole = random_batch(finger, 40)
    monkeypatch.setattr(follow, "PART", part)
    parts = random_batch(finger, 40)
    assert len(whole.events["design"]) > 0
    for name, events in whole.events.items():
        np.testing.assert_array_equal(parts.events[name], events)  # type: ignore[literal-required]
    for field in dataclasses.fields(Batch):
        one, other = getattr(whole, field.name), getattr(parts, field.name)
        if isinstance(one, np.ndarray):
            np.testing.assert_array_equal(other, one)
            assert other.dtype == one.dtype
    for index in (0, 23, 39):
        np.testing.assert_array_equal(parts[index].parameters, whole[index].parameters)
        assert len(parts[index].events) == len(whole[index].events)


def test_no_designs_are_a_batch_of_none(finger: Model) -> None:
    batch = random_batch(finger, 0)
    assert len(batch) == 0
    assert batch.joint_angles.shape == (0, 6, 3)
    assert batch.events["before"].shape == (0, 3)


def test_events_keep_the_joints_of_the_states_that_the_engine_tells(finger: Model) -> None:
    batch = random_batch(finger, 40)
    assert batch.geometry is not None
    indices, values = finger.geometry_slots(batch.geometry)
    events = finger.engine.path(indices, values, batch.loads, 1)["events"]
    assert events["before"].shape == (len(batch.events["design"]), finger.dof)
    for name in ("before", "after"):
        expected = events[name][:, finger.joint_columns]
        np.testing.assert_array_equal(batch.events[name], expected)


def test_one_line_says_what_it_is(finger: Model) -> None:
    assert repr(random_batch(finger, 3)).startswith("<Batch of 'finger': 3 designs, 6 steps, ")
    assert repr(finger.equilibrium("0:5:1")).startswith("<Path of 'finger': 6 steps to 5 N, stable")


def test_one_path_is_of_one_design(finger: Model) -> None:
    chosen = parameter_set("L", finger.design)
    with pytest.raises(flexor.InputError, match="design has 2 designs: give one"):
        finger.equilibrium(design=chosen.geometry([[0.08], [0.1]], finger.X))
