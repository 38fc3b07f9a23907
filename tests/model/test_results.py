"""Results of many designs are put together from chunks, and sliced down to one state."""

from __future__ import annotations

import dataclasses
import pickle

import numpy as np
import pytest

import flexor
from flexor.design import parameter_set
from flexor.model import Event, Model, Path, Paths, State, chunks
from flexor.model.result_arrays import Results, joinings
from flexor.model.results import States


@pytest.fixture(scope="module")
def finger() -> Model:
    return flexor.load("finger", "calibrated")


@pytest.fixture(scope="module")
def paths(finger: Model) -> Paths:
    return random_paths(finger, 40, gradient=True)


def random_paths(model: Model, count: int, **options: bool) -> Paths:
    chosen = parameter_set("L+R01", model.design)
    unit = np.random.default_rng(4).uniform(size=(count, chosen.size))
    designs = chosen.lower + unit * (chosen.upper - chosen.lower)
    return model.evaluate(chosen.geometry(designs, model.X), **options)


def check_same(one: object, other: object) -> None:
    if isinstance(one, np.ndarray) and one.dtype == object:
        assert isinstance(other, np.ndarray)
        for a, b in zip(one.flat, other.flat, strict=True):
            check_same(a, b)
    elif isinstance(one, np.ndarray):
        assert isinstance(other, np.ndarray)
        assert (one.dtype, one.shape) == (other.dtype, other.shape)
        assert one.tobytes() == other.tobytes()
    else:
        assert one == other


def arrays(results: Results) -> dict[str, object]:
    names = {field.name for field in dataclasses.fields(results)} - {"model", "followed"}
    return {name: getattr(results, name) for name in sorted(names)}


def test_without_straps_their_tensions_are_none() -> None:
    path = flexor.load("finger").equilibrium([0.0, 1.0])
    assert path.strap_tension.shape == (2, 0)
    assert path.strap_forces() == {}


def test_every_array_of_the_engine_says_how_components_join(finger: Model) -> None:
    """Those beside them are joined by their own rules."""
    none = np.zeros(0, dtype=np.intp)
    found = finger.engine.path(none, np.zeros((1, 0)), np.zeros((2, 1)), 1, steps=2)
    own = {"status", "stability", "friction", "free", "events"}
    assert found.keys() == {*joinings(), *own}
    for joining in joinings().values():
        assert (joining.how in ("rows", "shares")) == bool(joining.of)


@pytest.mark.parametrize("size", [1, 7, 40])
def test_chunks_leave_no_trace(
    finger: Model, paths: Paths, monkeypatch: pytest.MonkeyPatch, size: int
) -> None:
    monkeypatch.setattr(chunks, "SIZE", size)
    in_chunks = random_paths(finger, 40, gradient=True)
    assert paths.event_count.sum() > 0
    for name, array in arrays(paths).items():
        check_same(array, getattr(in_chunks, name))
    for index in (0, 23, 39):
        check_same(in_chunks[index].parameters, paths[index].parameters)


def test_no_designs_are_paths_of_none(finger: Model) -> None:
    none = random_paths(finger, 0, gradient=True)
    assert len(none) == 0
    assert none.joint_angles.shape == (0, 6, 3)
    assert none.events.shape == (0,)
    assert none.parameters.shape == (0, len(finger.parameters))
    assert list(none) == []


def test_slices_are_those_of_the_arrays(paths: Paths) -> None:
    path, state, states = paths[3], paths[3, -1], paths[:, 2]
    part, some = paths[5:20:3, 1:4], paths[np.arange(40) % 2 == 0]
    assert [type(each) for each in (path, state, states)] == [Path, State, States]
    assert [type(each) for each in (part, some, path[1:3])] == [Paths, Paths, Path]
    assert (len(path), len(states), len(part), len(some), len(path[1:3])) == (6, 40, 5, 20, 2)
    check_same(path.q, paths.q[3])
    check_same(state.q, paths.q[3, -1])
    check_same(states.joint_angles, paths.joint_angles[:, 2])
    check_same(part.energy, paths.energy[5:20:3, 1:4])
    check_same(part.force, paths.force[1:4])
    check_same(some.gradient, paths.gradient[::2])
    assert (state.force, state.status, state.loads.shape) == (5.0, "converged", (1,))
    for one, other in ((path[-1], state), (states[7], paths[7, 2]), (part[1, 0], paths[8, 1])):
        for name, array in arrays(one).items():
            check_same(array, getattr(other, name))
    assert [each.force for each in path] == path.force.tolist()
    check_same(paths.parameters[3], state.parameters)
    with pytest.raises(IndexError):
        paths[40]
    with pytest.raises(IndexError):
        path[0, 0]


def test_events_go_with_their_design_and_step(finger: Model, paths: Paths) -> None:
    indices, values = finger.geometry_slots(paths)
    found = finger.engine.path(indices, values, paths.loads, 1)["events"]
    assert found["before"].shape == (paths.event_count.sum(), finger.dof)
    told = [event for events in paths.events for event in events]
    assert len(told) == len(found["design"]) > 0
    for name, key in (("angles_before", "before"), ("angles_after", "after")):
        expected = found[key][:, finger.joint_columns]
        np.testing.assert_array_equal([getattr(event, name) for event in told], expected)
    design, step = int(found["design"][0]), int(found["step"][0])
    there, later = paths[design, step].events, paths[design, step:].events
    assert isinstance(there[0], Event)
    assert there[0].force == found["load"][0, 0]
    assert there[0].step == later[0].step == 0
    assert len(paths[:, step].events[design]) == len(there)
    assert sum(len(state.events) for state in paths[design]) == len(paths[design].events)


def test_a_state_is_that_of_its_path(paths: Paths) -> None:
    path = paths[11]
    for step in (0, 3, -1):
        state = path[step]
        for name in ("frames", "spheres"):
            one, other = getattr(state, name)(), getattr(path, name)(step)
            assert list(one) == list(other)
            for key in one:
                np.testing.assert_array_equal(one[key], other[key])
        np.testing.assert_array_equal(state.contact_forces().force, path.contact_forces(step).force)


def test_results_are_pickled(paths: Paths) -> None:
    for results in (paths, paths[3], paths[3, -1]):
        copy = pickle.loads(pickle.dumps(results))
        assert type(copy) is type(results)
        assert copy.model.hash == paths.model.hash  # type: ignore[attr-defined]
        for name, array in arrays(results).items():
            check_same(array, getattr(copy, name))


def test_a_study_records_some_of_the_arrays(paths: Paths) -> None:
    recorded = paths.recorded()
    assert len(pickle.dumps(recorded)) < 0.2 * len(pickle.dumps(paths))
    assert recorded.model is None
    assert recorded.q is None
    assert recorded[3].events is None
    check_same(recorded[3].joint_angles, paths[3].joint_angles)
    joined = Paths.concatenate([recorded[:15], recorded[15:]])
    for name, array in arrays(recorded).items():
        check_same(array, getattr(joined, name))
    assert repr(recorded).startswith("<Paths of recorded designs: 40 designs, 6 steps, ")


def test_one_line_says_what_it_is(finger: Model, paths: Paths) -> None:
    assert repr(paths[:3]).startswith("<Paths of 'finger': 3 designs, 6 steps, ")
    path = finger.equilibrium("0:5:1")
    assert repr(path).startswith("<Path of 'finger': 6 steps to 5 N, stable")
    assert repr(path[-1]) == "<State of 'finger': 5 N, converged, stable>"


def test_one_path_is_of_one_design(finger: Model) -> None:
    chosen = parameter_set("L", finger.design)
    with pytest.raises(flexor.InputError, match="design has 2 designs: give one"):
        finger.equilibrium(design=chosen.geometry([[0.08], [0.1]], finger.X))
