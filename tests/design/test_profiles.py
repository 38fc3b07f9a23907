"""Sizes that vary along a rod: values, exact derivatives, studies, errors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import flexor
from flexor.design import mapped, variables
from flexor.design.variables import Variables
from flexor.errors import InputError
from flexor.model import Model, parse
from flexor.model.schema.profile import spline_basis, spline_points
from flexor.scenarios import tolerances
from flexor.study import Problem, Study, optimize, resume

ENDS = {
    "exosuit.radius": ("6 mm", "9 mm", "spline 4"),
    "exosuit.section.wall": ("1.5 mm", "2.5 mm", "spline 3"),
    "exosuit.section.floor": ("1.8 mm", "3 mm", "spline 5"),
    "exosuit.section.layer.thickness": ("0.3 mm", "0.6 mm", "spline 2"),
    "exosuit.length": ("9 cm", "11 cm"),
    "proximal.to.at": (0.45, 0.65),
}


@pytest.fixture(scope="module")
def model() -> Model:
    """Return the pneumatic finger with fewer elements, which cannot touch itself."""
    coarse = {"exosuit.elements": 10, "proximal.at": 0.3, "distal.at": 0.8}
    return flexor.load("pneumatic-finger", changes={"exosuit.self_contact": False, **coarse})


@pytest.fixture(scope="module")
def problem(model: Model) -> Problem:
    """Return a problem in which everything that may vary along a rod does."""
    return Problem.of(
        model,
        ENDS,
        "maximise range-of-motion",
        subject_to=["overlap <= 1.5 mm", "volume <= 10 mL"],
        without=["stretch"],  # at rest all stretches are tied
        options={"tolerance": 1e-12},
    )


def test_a_spline_is_linear_in_its_control_values_and_stays_between_them() -> None:
    X = np.linspace(0.0, 1.0, 201)
    for count in (1, 2, 3, 4, 7):
        values, slopes = spline_basis(count, X)
        np.testing.assert_allclose(values.sum(axis=1), 1.0, atol=1e-14)
        assert values.min() >= 0.0
        np.testing.assert_allclose(values[[0, -1]][:, [0, -1]], np.eye(2) if count > 1 else 1.0)
        if count > 1:
            # A line through the points where the values act is that line.
            np.testing.assert_allclose(values @ (2.0 + spline_points(count)), 2.0 + X, rtol=1e-14)
            np.testing.assert_allclose(slopes @ spline_points(count), 1.0, rtol=1e-12)


def test_the_start_is_the_size_that_the_file_has(model: Model, problem: Problem) -> None:
    here = problem.evaluate(problem.parameters.start[None, :])
    plain = Problem.of(
        model, {"exosuit.length": ENDS["exosuit.length"]}, "maximise range-of-motion"
    )
    own = plain.evaluate(plain.parameters.start[None, :])
    assert here.shown[0] == pytest.approx(own.shown[0], rel=1e-8)


def test_values_are_those_of_the_changed_file(model: Model, problem: Problem) -> None:
    chosen = problem.parameters
    assert isinstance(chosen, Variables)
    rng = np.random.default_rng(1)
    x = chosen.lower + rng.uniform(size=(3, chosen.size)) * (chosen.upper - chosen.lower)
    found, _ = chosen.designs(x, problem.model)
    for row in range(2):
        # Of the file as it was: the changes make its sizes splines.
        expected = flexor.load(model.file, changes=chosen.changes(x[row])).parameters
        actual = problem.model.parameters.copy()
        actual[found.indices] = found.values[row]
        np.testing.assert_allclose(actual, expected, rtol=1e-9, atol=1e-12)
        alone = chosen.designs(x[[row]], problem.model)[0].values
        assert alone.tobytes() == found.values[row].tobytes()


CONSTANT = """
name = "suit"
planar = true
[materials]
silicone = { library = "dragon-skin-30", winding = "hoop" }
[bodies.suit]
kind = "rod"
length = "10 cm"
radius = "8 mm"
material = "silicone"
section = { kind = "half-round", wall = "2 mm", floor = "2.5 mm" }
strain = { bend_y = "nodal_linear", extend_x = "nodal_linear" }
elements = 4
gauss_points = 2
"""


def test_walls_vary_on_a_rod_of_constant_radius() -> None:
    """Whose slope is zero but for rounding."""
    model = Model(parse(CONSTANT))
    chosen = variables({"suit.section.wall": ("1.5 mm", "3 mm", "spline 3")}, model)
    x = np.array([1.6e-3, 2.9e-3, 2.2e-3])
    made = chosen.prepared(model)
    found, _ = chosen.designs(x[None, :], made)
    actual = made.parameters.copy()
    actual[found.indices] = found.values[0]
    expected = flexor.load(model.file, changes=chosen.changes(x)).parameters
    np.testing.assert_allclose(actual, expected, rtol=1e-9, atol=1e-12)
    assert variables({"suit.radius": ("7 mm", "9 mm")}, model).labels == ("suit.radius",)


def test_gradients_are_those_of_differences(problem: Problem) -> None:
    chosen, n = problem.parameters, 2
    span = chosen.upper - chosen.lower
    rng = np.random.default_rng(3)
    x = chosen.lower + rng.uniform(0.1, 0.9, (n, chosen.size)) * span
    directions = rng.standard_normal((n, chosen.size)) * span
    here = problem.evaluate(x, gradient=True)
    exact = np.concatenate([here.value_gradient[:, None], here.constraint_gradients], axis=1)
    size = np.abs(exact * span).max(axis=2)
    regular = np.column_stack([here.regularity, here.constraint_regularity]) == "regular"
    assert regular.mean() >= 0.5
    total = np.zeros(regular.shape)
    for at, weight in {1: 45 / 60, 2: -9 / 60, 3: 1 / 60}.items():
        for sign in (1, -1):
            moved = problem.evaluate(x + sign * at * 2e-4 * directions)
            values = np.column_stack([moved.value, moved.constraint_values])
            total += sign * weight * values / 2e-4
            regular &= (moved.touching == here.touching).all(axis=1)[:, None]
    error = np.abs(np.einsum("nck,nk->nc", exact, directions) - total) / size
    assert regular.any(axis=0).all()
    assert error[regular].max() <= 1e-6


def test_a_study_is_opened_and_resumed_and_gives_a_model_file(model: Model, tmp_path: Path) -> None:
    varied = {"exosuit.section.wall": ("1.5 mm", "2.5 mm", "spline 3")}
    whole = optimize(model, varied, "maximise range-of-motion", budget=12)
    study = optimize(model, varied, "maximise range-of-motion", folder=tmp_path / "s", budget=6)
    study.close()
    assert (
        Study.open(tmp_path / "s").problem.parameters.labels[2] == "exosuit.section.wall.spline.2"
    )
    done = resume(tmp_path / "s", budget=12)
    assert done.record.designs().tobytes() == whole.record.designs().tobytes()
    best = done.best
    assert isinstance(done.problem.parameters, Variables)
    saved = flexor.load(model.file, changes=done.problem.parameters.changes(best.vector))
    wall = saved.file.rod("exosuit").section.wall
    assert [float(each) for each in wall.spline] == best.vector.tolist()
    assert best.model.hash == saved.hash


def test_fields_may_be_functions_of_other_parameters(model: Model) -> None:
    """A profile and a length from two parameters, with derivatives of differences."""
    chosen = mapped(
        "bulge",
        ["ends", "rise"],
        [1.6e-3, 0.0],
        [2e-3, 3e-3],
        [1.8e-3, 1e-3],
        {
            "exosuit.section.wall": (lambda p, X: p[0] + p[1] * X * (1.0 - X), "spline 6"),
            "exosuit.length": lambda p: 0.1 + p[1],
        },
        model,
        units=["mm", "mm"],
    )
    problem = Problem.of(model, chosen, "maximise range-of-motion", options={"tolerance": 1e-12})
    x, step = chosen.start, 1e-3 * (chosen.upper - chosen.lower)
    here = problem.evaluate(x[None, :], gradient=True)
    for k in range(2):
        e = step[k] * np.eye(2)[k]
        ends = problem.evaluate(np.stack([x + e, x - e, x + 2 * e, x - 2 * e])).value
        slope = (8.0 * (ends[0] - ends[1]) - (ends[2] - ends[3])) / (12.0 * step[k])
        assert here.value_gradient[0, k] == pytest.approx(slope, rel=1e-6)
    file = flexor.load(model.file, changes=chosen.changes(x)).file
    assert float(file.rod("exosuit").length) == 0.101
    X = spline_points(6)
    expected = (1.8e-3 + 1e-3 * X * (1.0 - X)).tolist()
    assert [float(each) for each in file.rod("exosuit").section.wall.spline] == expected


@pytest.mark.parametrize(
    ("label", "third", "message"),
    [
        ("exosuit.radius", "splin 4", 'did you mean "spline"'),
        ("exosuit.radius", "spline", "the number of control values, 2 to 40"),
        ("exosuit.radius", "spline 1", "the number of control values, 2 to 40"),
        ("exosuit.length", "spline 4", "cannot vary along a rod"),
        ("ph_1.radius", "spline 4", "cannot vary along a rod"),
        ("exosuit.section.wal", "spline 4", "cannot vary along a rod"),
        ("exosuit.section.width", "spline 4", 'unknown key "width"'),
    ],
)
def test_bad_profiles(label: str, third: str, message: str, model: Model) -> None:
    with pytest.raises(InputError, match=message):
        variables({label: ("6 mm", "9 mm", third)}, model)


def test_bad_functions(model: Model) -> None:
    def made(function: object, field: str = "exosuit.length") -> None:
        mapped("mine", ["p"], [0.1], [0.2], [0.1], {field: function}, model)  # type: ignore[dict-item]

    with pytest.raises(InputError, match=r'"exosuit.length" depends on no parameter'):
        made(lambda p: 0.1)
    with pytest.raises(InputError, match="returned complex numbers"):
        made(lambda p: p[0] + 1j)
    with pytest.raises(InputError, match="must return a number"):
        made(lambda p: p * np.ones(3))
    with pytest.raises(InputError, match="is a load, which has no function"):
        made(lambda p: p[0], "evaluation.pressure")
    with pytest.raises(InputError, match="does not return finite numbers"):
        made(lambda p: np.nan)


def test_a_tolerance_of_a_size_is_one_of_each_control_value(model: Model) -> None:
    chosen = variables({"exosuit.radius": ENDS["exosuit.radius"]}, model)
    given = {"exosuit.radius.base": "0.5 mm", "exosuit.radius.tip": "0.2 mm"}
    found = tolerances(given, chosen, chosen.prepared(model))
    assert [each.field for each in found] == list(chosen.labels)
    # Between both ends the radius is made as exactly as at the worse one.
    assert [each.size for each in found] == [0.5e-3, 0.5e-3, 0.5e-3, 0.2e-3]
    one = tolerances({"exosuit.radius.tip": "0.1 mm normal"}, chosen, chosen.prepared(model))
    assert [each.field for each in one] == list(chosen.labels)[1:]
    assert {each.text for each in one} == {"0.1 mm normal"}
    own = {**given, "exosuit.radius.spline.1": "0.3 mm"}
    found = tolerances(own, chosen, chosen.prepared(model))
    assert sorted(each.size for each in found) == [0.2e-3, 0.3e-3, 0.5e-3, 0.5e-3]
    every = tolerances({"exosuit.radius": "0.5 mm"}, chosen, chosen.prepared(model))
    assert [each.field for each in every] == list(chosen.labels)
    assert {each.size for each in every} == {0.5e-3}
    # So it is where the file has the spline and nothing of it varies.
    length = variables({"exosuit.length": ("9 cm", "11 cm")}, model)
    of_file = tolerances({"exosuit.radius": "0.5 mm"}, length, chosen.prepared(model))
    assert [each.field for each in of_file] == list(chosen.labels)
