"""The centreline of a rod in what it touches: its depth, its derivatives, and the constraint."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.constraints import chosen_constraints, default_constraints
from flexor.errors import InputError
from flexor.model import Model, parse
from flexor.observables import observable
from flexor.study import Problem

# A cantilever of 1 mm that is pushed onto a post of 1 cm, as soft as a sponge.
ARM = """
name = "arm"
planar = true

[bodies.arm]
kind = "rod"
length = "10 cm"
radius = "1 mm"
section = { kind = "circular" }
young_modulus = "50 MPa"
poisson_ratio = 0.45
density = "1 g/cm^3"
strain = { bend_y = "nodal_linear" }
elements = 8
gauss_points = 2

[bodies.post]
kind = "link"
length = "2 cm"
radius = "1 cm"
joint = { kind = "fixed" }
placement = { x = "6 cm", z = "-1.15 cm" }

[spheres]
arm = { bodies = ["arm"] }
post = { bodies = ["post"] }

[contacts.touch]
first = "arm"
second = "post"
shape = "round-cones"
stiffness = "0.2 N/mm"

[wrenches.push]
body = "arm"
at = "tip"
force = { z = "-1 N" }
input = true

[evaluation]
loads.push = "0 N, 0.1 N, 0.2 N, 0.6 N"
"""
VARIED: dict[str, tuple[object, object]] = {
    "arm.radius": ("0.9 mm", "1.1 mm"),
    "arm.length": ("9.8 cm", "10.2 cm"),
    "post.radius.tip": ("9 mm", "10 mm"),
    "touch.stiffness": ("0.15 N/mm", "0.3 N/mm"),
}


@pytest.fixture(scope="module")
def model() -> Model:
    """Return the cantilever."""
    return Model(parse(ARM))


def test_the_depth_is_that_of_the_nearest_sample_point(model: Model) -> None:
    """From the places of sample points and the radius of the post; none before they touch."""
    path = model.equilibrium()
    found = observable("centreline-depth", model).values(path.as_batch)[0]
    assert path.converged.all()
    start, stop = model.body_frames["arm"]
    for step, depth in enumerate(found):
        q = path.q[step]
        places = np.array(model.engine.frames(path.parameters, q))[start:stop, :3, 3]
        along = np.clip(places[:, 0], 0.06, 0.08)
        apart = np.hypot(places[:, 0] - along, places[:, 2] + 0.0115)
        if path.max_overlap[step] == 0.0:
            assert np.isnan(depth)
        else:
            assert depth == pytest.approx((0.01 - apart).max(), abs=1e-9)
    assert np.isnan(found[0])
    assert found[2] < 0.0 < found[3]


def test_derivatives_are_those_of_differences(model: Model) -> None:
    """Through the state, the radii and the places."""
    bounds = ["centreline-depth <= 1 mm at end", "overlap <= 5 mm at end"]
    options = {"tolerance": 1e-12}
    words = {"subject_to": bounds, "without": ["defaults"], "options": options}
    problem = Problem.of(model, VARIED, "maximise rod-bending.arm", **words)  # type: ignore[arg-type]
    chosen = problem.parameters
    x = chosen.lower + 0.37 * (chosen.upper - chosen.lower)
    here = problem.evaluate(x[None, :], 1, gradient=True)
    assert (here.constraint_regularity == "regular").all()
    step = 1e-4 * (chosen.upper - chosen.lower)
    for k, size in enumerate(step):
        ends = []
        for sign in (1.0, -1.0):
            moved = x.copy()
            moved[k] += sign * size
            ends.append(problem.evaluate(moved[None, :], 1).constraint_values[0])
        slopes = (ends[0] - ends[1]) / (2.0 * size)
        largest = np.abs(here.constraint_gradients[0] * step).max(axis=1) / size
        assert (np.abs(here.constraint_gradients[0, :, k] - slopes) <= 1e-6 * largest).all()


def test_it_holds_by_default_and_can_be_switched_off(model: Model) -> None:
    """By its own name, beside the overlap."""
    names = [each.default for each in default_constraints(model)]
    assert names == ["overlap", "centreline"]
    assert chosen_constraints([], [], model) == default_constraints(model)
    # From this bound it follows.
    assert len(chosen_constraints(["overlap <= 0.5 mm"], [], model)) == 1
    assert len(chosen_constraints(["overlap <= 0.6 mm"], [], model)) == 2
    kept = chosen_constraints([], ["overlap"], model)
    assert [each.text(model) for each in kept] == ["centreline-depth <= 0 mm"]
    assert not chosen_constraints([], ["overlap", "centreline"], model)
    with pytest.raises(InputError, match='did you mean "centreline"'):
        chosen_constraints([], ["centerline"], model)


def test_a_device_in_the_body_is_refused_where_overlaps_are_not(model: Model) -> None:
    """With `overlap` switched off, and of a rod thinner than what overlaps may be."""
    words = ("maximise rod-bending.arm",)
    without = flexor.optimize(model, VARIED, *words, without=["overlap"], budget=20)
    assert without.best is not None
    assert not without.best.feasible
    (broken,) = [each for each in without.best.verdict.constraints if each.default == "centreline"]
    assert broken.number > 0.0
    assert broken.excess > 0.0
    neither = flexor.optimize(model, VARIED, *words, without=["overlap", "centreline"], budget=20)
    assert neither.best is not None
    assert neither.best.feasible


def test_a_rod_thinner_than_what_may_overlap_is_not_in_the_body() -> None:
    """An overlap of less than 1 mm is kept where the centreline of a rod of 0.3 mm is inside."""
    loads = {"evaluation.loads.push": "0 N, 0.1 N, 0.2 N"}
    thin = {"arm.radius": "0.3 mm", "arm.young_modulus": "5 GPa"}
    model = Model(parse(ARM, changes={**loads, **thin}))
    problem = Problem.of(model, {"arm.length": ("9.9 cm", "10.1 cm")}, "maximise rod-bending.arm")
    found = problem.evaluate(problem.parameters.start[None, :], 1)
    values = dict(
        zip((each.default for each in problem.constraints), found.constraint_values[0], strict=True)
    )
    assert 0.3e-3 < values["overlap"] < 1e-3
    assert values["centreline"] > 0.0
    assert found.violation[0] > 0.0
