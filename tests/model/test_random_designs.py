"""Random designs and the corners of the search bounds: each ends well, whatever the load step."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import flexor
from flexor import _engine
from flexor.design import parameter_set
from flexor.model import Model, Paths

COUNTS = {"calibrated": 80, "printed": 8}  # printed constants snap some thirty times a design


def batch_of(model: Model, vectors: NDArray[np.float64], force: str) -> Paths:
    return model.evaluate(parameter_set("L+R01", model.design).geometry(vectors, model.X), force)


@pytest.fixture(scope="module", params=COUNTS)
def case(request: pytest.FixtureRequest) -> tuple[Model, NDArray[np.float64], Paths]:
    model = flexor.load("finger", constants=request.param)
    chosen = parameter_set("L+R01", model.design)
    unit = np.random.default_rng(5).uniform(size=(COUNTS[request.param], 3))
    unit = np.concatenate([np.indices((2, 2, 2)).reshape(3, -1).T, unit])
    vectors = chosen.lower + unit * (chosen.upper - chosen.lower)
    return model, vectors, batch_of(model, vectors, "0:5:1")


def test_every_design_converges_to_a_stable_equilibrium(case) -> None:
    model, vectors, batch = case
    assert batch.status.shape == (len(vectors), 6)
    assert set(batch.status.flat) <= set(_engine.STATUS)
    assert batch.converged.all()
    assert batch.stable.all()
    for numbers in (batch.q, batch.energy, batch.residual, batch.tip_force):
        assert np.isfinite(numbers).all()
    tangents = [
        model.engine.tangent(batch[index].parameters, batch.q[index, -1], batch.loads[-1])
        for index in range(0, len(vectors), 7)
    ]
    assert all(np.linalg.eigvalsh(tangent).min() > 0.0 for tangent in tangents)


@pytest.mark.parametrize("case", ["calibrated"], indirect=True)
def test_without_an_event_the_load_step_does_not_matter(case) -> None:
    model, vectors, coarse = case
    fine = batch_of(model, vectors, "0:5:0.1")
    first = np.full(len(vectors), np.inf)
    for batch in (coarse, fine):
        tables = enumerate(batch.event_table)
        first = np.array([min([first[i], *table["force"]]) for i, table in tables])
    without = np.isinf(first)
    apart = np.abs(coarse.joint_angles - fine.joint_angles[:, ::10])
    assert without.mean() > 0.5
    assert apart[without].max() <= 1e-8
    assert coarse.joint_angles[without, -1].sum(axis=1).max() > 1.0
    # Events are found so closely that what follows them is the same, too.
    assert (apart <= 1e-8).all(axis=(1, 2)).mean() > 0.99


def test_every_event_tells_force_and_angles_on_both_sides(case) -> None:
    _, _, batch = case
    events = [event for path in batch for event in path.events]
    assert len(events) == batch.event_count.sum() > 0
    for event in events:
        assert 0.0 <= event.force <= 5.0
        assert event.kind in _engine.EVENTS
        for angles in (event.angles_before, event.angles_after):
            assert angles.shape == (3,)
            assert np.isfinite(angles).all()
