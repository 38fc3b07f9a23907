"""Columns buckle at the load of the eigenvalue problem and return without an event."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

import flexor
from flexor.model import Model, parse

LINK = """
[bodies.b{i}]
kind = "link"
{parent}
length = "{length} m"
radius = "2 mm"
joint = {{ kind = "{joint}", stiffness = "{stiffness} N*m/rad" }}
"""
LOAD = """
[wrenches.p]
body = "b{last}"
at = "tip"
force = {{ x = "-1 N" }}
frame = "world"
input = true
"""


def random_column(seed: int, joint: str) -> tuple[Model, float]:
    """Return a column of hinged links and the load at which it buckles [N]."""
    random = np.random.default_rng(seed)
    count = int(random.integers(2, 6))
    lengths = random.uniform(0.05, 0.3, count)
    stiffness = 10 ** random.uniform(-2.5, -0.5, count)
    text = 'name = "column"\n'
    for i in range(count):
        parent = f'parent = "b{i - 1}"' if i else ""
        text += LINK.format(
            i=i, parent=parent, length=lengths[i], joint=joint, stiffness=stiffness[i]
        )
    # ½ Σ k_i q_i² − P Σ l_i (1 − cos φ_i), φ_i = q_1 + … + q_i.
    sums = np.tril(np.ones((count, count)))
    geometric = sums.T @ np.diag(lengths) @ sums
    critical = scipy.linalg.eigh(np.diag(stiffness), geometric, eigvals_only=True)[0]
    return Model(parse(text + LOAD.format(last=count - 1))), float(critical)


@pytest.mark.parametrize("joint", ["revolute", "spherical"])
def test_a_column_returns_from_its_buckled_shape_without_an_event(joint: str) -> None:
    for seed in range(25):
        model, critical = random_column(seed, joint)
        top = critical * np.random.default_rng(seed).uniform(1.2, 4.0)
        up = np.linspace(0.0, top, 21)
        for loads in ([0.0, top, 0.0], [0.0, -top, top, 0.9 * critical], [*up, *up[::-1]]):
            path = model.equilibrium(loads)
            assert path.converged.all()
            assert [event.kind for event in path.events] == ["bifurcation"]
            assert path.events[0].force == pytest.approx(critical, rel=1e-6)
            assert np.abs(path.q).max() > 1e-2
            assert np.abs(path.q[-1]).max() < 1e-6


@pytest.mark.parametrize(
    "loads", [[0.24, 0.0], [0.2, 0.0], [0.13, 0.1], [0.13, 0.122, 0.121, 0.12]]
)
def test_a_rod_returns_from_its_buckled_shape_without_an_event(loads: list[float]) -> None:
    path = flexor.load("column").equilibrium([0.0, *loads])
    assert path.converged.all()
    assert [event.kind for event in path.events] == ["bifurcation"]
    assert np.abs(path.q[-1]).max() < 1e-6


KOITER = """
name = "bar"
planar = true
[bodies.bar]
kind = "link"
length = "1 m"
radius = "1 cm"
joint = {{ kind = "revolute", axis = "y", stiffness = "0 N*m/rad" }}
[springs.s]
stiffness = "100 N/m"
rest_length = "{rest} m"
first = {{ body = "bar", at = "tip" }}
second = {{ world = {{ z = "{side} m" }} }}
[wrenches.p]
body = "bar"
at = "tip"
force = {{ x = "-1 N" }}
frame = "world"
input = true
"""


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize(
    "loads",
    [[0, 80], [0, 55], [0, 49.99, 50.01], *(np.linspace(0, 80, n) for n in (11, 101, 301))],
)
def test_an_asymmetric_branch_point_is_found_at_its_load(side: int, loads: list[float]) -> None:
    # A bar held by a spring at 45° loses stability at kL/2; some sub-steps end exactly there. It
    # leans continuously to the side of the spring, and would fall to the other.
    model = Model(parse(KOITER.format(rest=np.sqrt(2.0), side=side)))
    path = model.equilibrium(loads)
    assert path.converged.all()
    assert [event.kind for event in path.events] == ["bifurcation"]
    if loads[-1] > 50.1:
        assert side * path.q[-1, 0] < 0.0
    assert path.events[0].force == pytest.approx(50.0, rel=1e-6)
