"""What a design comes to depends on the design alone, and a snap only ever goes down."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

import flexor
from flexor.design import parameter_set
from flexor.model import Model, Paths

SETS = {"finger": "L+R01", "tendon-arm": "L+Rsc"}


@pytest.fixture(scope="module")
def models() -> dict[str, Model]:
    return {name: flexor.load(name) for name in SETS}


def evaluated(model: Model, vectors: NDArray[np.float64], threads: int) -> Paths:
    chosen = parameter_set(SETS[model.name], model.design)
    geometry = chosen.geometry(vectors, model.X)
    # Also designs that do not get far, and after which the next must not be another.
    return model.evaluate(geometry, "0:5:2.5", threads, gradient=True, max_iterations=60)


def bits(batch: Paths, row: int) -> tuple[object, ...]:
    assert batch.gradient is not None
    assert batch.regularity is not None
    arrays = (
        batch.q,
        batch.converged,
        batch.iterations,
        batch.residual,
        batch.energy,
        batch.tip_force,
    )
    events = batch.event_table[row].tobytes()
    counts = (
        batch.tip_force[row].tobytes(),
        batch.pairs[row].tobytes(),
        batch.touching[row].tobytes(),
        batch.regularity[row],
        *batch.status[row],
    )
    return (*(a[row].tobytes() for a in arrays), *counts, batch.gradient[row].tobytes(), events)


@settings(deadline=None, max_examples=8)
@given(
    name=st.sampled_from(list(SETS)),
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(1, 40),
    threads=st.integers(2, 5),
)
def test_neither_threads_nor_neighbours_matter(
    models: dict[str, Model], name: str, seed: int, count: int, threads: int
) -> None:
    model = models[name]
    chosen = parameter_set(SETS[name], model.design)
    random = np.random.default_rng(seed)
    vectors = random.uniform(chosen.lower, chosen.upper, size=(count, chosen.size))
    vectors[random.uniform(size=count) < 0.2, 0] *= 30.0  # far out, so that some fail
    one, several = evaluated(model, vectors, 1), evaluated(model, vectors, threads)
    order = random.permutation(count)
    shuffled = evaluated(model, vectors[order], threads)
    for row in range(count):
        assert bits(several, row) == bits(one, row)
        assert bits(shuffled, int(np.flatnonzero(order == row)[0])) == bits(one, row)
    alone = int(random.integers(count))
    assert bits(evaluated(model, vectors[alone : alone + 1], 1), 0) == bits(one, alone)


@pytest.mark.parametrize("constants", ["printed", "calibrated"])
def test_a_snap_ends_with_less_energy_than_it_began(constants: str) -> None:
    model = flexor.load("finger", constants)
    chosen = parameter_set("L+R01", model.design)
    random = np.random.default_rng(2)
    vectors = random.uniform(chosen.lower, chosen.upper, size=(12, chosen.size))
    geometry = chosen.geometry(vectors, model.X)
    indices, values = model.geometry_slots(geometry)
    loads = np.array([[0.0], [2.5], [5.0]])
    found = model.engine.path(indices, values, loads, 1)["events"]
    assert len(found["design"]) > 0
    for design, load, before, after in zip(
        *(found[key] for key in ("design", "load", "before", "after")), strict=True
    ):
        parameters = model.parameters.copy()
        parameters[indices] = values[design]
        high, low = (model.engine.energy(parameters, q, load) for q in (before, after))
        assert low < high
