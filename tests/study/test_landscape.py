"""Landscapes of an analytic model: arrays, minimum, roughness, files, resuming, figures."""

from __future__ import annotations

import csv
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from flexor import plot
from flexor.errors import InputError
from flexor.study import Study, optimize, resume
from flexor.study.landscape import Landscape, SearchPath, landscape


def direct(analytic: ModuleType, designs: np.ndarray) -> np.ndarray:
    """Values of designs (n, 2) of R01 without a study."""
    from flexor.design import parameter_set
    from flexor.objectives import objective
    from flexor.study import Problem

    model = analytic.AnalyticModel()
    return (
        Problem(model, parameter_set("R01", model.design), objective("f_b")).evaluate(designs).value
    )


def test_every_array_is_that_of_its_design(analytic: ModuleType) -> None:
    found = landscape(analytic.AnalyticModel(), "R01", "f_b", grid=25)
    assert found.labels == ("R_0", "R_1")
    assert [axis.shape for axis in found.axes] == [(25,), (25,)]
    assert (found.axes[0][0], found.axes[0][-1]) == (0.004, 0.012)
    X, Y = np.meshgrid(*found.axes, indexing="ij")
    np.testing.assert_array_equal(found.designs[..., 0], X)
    np.testing.assert_array_equal(found.designs[..., 1], Y)
    expected = direct(analytic, np.stack((X.ravel(), Y.ravel()), axis=1)).reshape(25, 25)
    np.testing.assert_array_equal(found.value, expected)
    np.testing.assert_array_equal(found.failed, Y < 0.0045)
    np.testing.assert_array_equal(found.events > 0, X < 0.005)
    assert set(found.reason[found.failed]) == {"did not converge at 3 N (iteration limit)"}
    good = ~found.failed
    np.testing.assert_allclose(found.shown[good], found.joint_angles[good].sum(axis=-1), rtol=1e-14)
    assert found.minimum_index == np.unravel_index(np.argmin(expected), (25, 25))
    np.testing.assert_array_equal(found.minimum.vector, found.designs[found.minimum_index])
    assert found.minimum.value == expected.min()


def test_local_minima_are_those_found_one_by_one(analytic: ModuleType) -> None:
    found = landscape(analytic.AnalyticModel(), "R01", grid=61)
    value, minima = found.value, set()
    for i in range(61):
        for j in range(61):
            around = value[max(i - 1, 0) : i + 2, max(j - 1, 0) : j + 2]
            if np.isfinite(value[i, j]) and np.sum(around <= value[i, j]) == 1:
                minima.add((i, j))
    assert len(minima) > 1
    assert {tuple(index) for index in found.local_minima().tolist()} == minima


def test_one_axis_or_two_of_more_with_the_others_at_the_start(analytic: ModuleType) -> None:
    model = analytic.AnalyticModel()
    line = landscape(model, "L", grid=31)
    assert line.value.shape == (31,)
    assert line.minimum.vector[0] == pytest.approx(0.11, abs=0.04 / 30)
    start = [0.09, 0.007, 0.0081]
    plane = landscape(model, "L+R01", grid=9, axes=["R_1", "L"], start=start)
    assert plane.labels == ("R_1", "L")
    assert np.all(plane.designs[..., 1] == 0.007)
    np.testing.assert_allclose(plane.designs[:, 3, 2], np.linspace(0.004, 0.012, 9))
    np.testing.assert_allclose(plane.designs[3, :, 0], np.linspace(0.06, 0.14, 9))
    curve = landscape(model, "L+R01", grid=9, axes=["L"], bounds={"L": (0.08, 0.12)})
    np.testing.assert_allclose(curve.designs[:, 0], np.linspace(0.08, 0.12, 9))
    assert np.all(curve.designs[:, 1:] == [0.0116, 0.008])


def test_it_is_a_study_that_resumes_and_opens(analytic: ModuleType, tmp_path: Path) -> None:
    whole = landscape(analytic.AnalyticModel(), "R01", grid=40)
    model = analytic.AnalyticModel()

    class Killed(BaseException):
        pass

    def kill(model: Any) -> None:
        if len(model.calls) == 3:
            raise Killed

    model.before_batch = kill
    with pytest.raises(Killed):
        landscape(model, "R01", grid=40, folder=tmp_path / "l")
    half = Study.open(tmp_path / "l", model=analytic.AnalyticModel())
    with pytest.raises(InputError, match="has 768 of 1,600 designs: resume it"):
        Landscape.of(half)
    told: list[int] = []
    again = landscape(
        analytic.AnalyticModel(),
        "R01",
        grid=40,
        folder=tmp_path / "l",
        resume=True,
        progress=lambda at: told.append(at.remaining or 0),
    )
    np.testing.assert_array_equal(again.value, whole.value)
    np.testing.assert_array_equal(again.events, whole.events)
    assert told == sorted(told, reverse=True)
    assert told[-1] == 0
    opened = Landscape.of(Study.open(tmp_path / "l", model=analytic.AnalyticModel()))
    np.testing.assert_array_equal(opened.value, whole.value)
    with pytest.raises(InputError, match='" is not a study: it is a landscape'):
        resume(tmp_path / "l", model=analytic.AnalyticModel())
    with pytest.raises(InputError, match=r"method\.options\.points = 40, not 41"):
        landscape(analytic.AnalyticModel(), "R01", grid=41, folder=tmp_path / "l", resume=True)


def test_files_hold_every_number(analytic: ModuleType, tmp_path: Path) -> None:
    found = landscape(analytic.AnalyticModel(), "R01", grid=7)
    found.save(tmp_path)
    arrays = np.load(tmp_path / "landscape.npz")
    np.testing.assert_array_equal(arrays["value"], found.value)
    np.testing.assert_array_equal(arrays["axis_1"], found.axes[1])
    np.testing.assert_array_equal(arrays["reason"], found.reason.astype(str))
    with open(tmp_path / "landscape.csv", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    assert rows[0][:4] == ["R_0 [m]", "R_1 [m]", "objective bending", "bending [rad]"]
    assert len(rows) == 1 + 49
    assert float(rows[20][2]) == found.value[2, 5]
    assert rows[1][2] == ""
    assert rows[1][-1] == found.reason[0, 0]
    with pytest.raises(InputError, match="the landscape cannot be written into"):
        found.save(tmp_path / "missing")


def test_the_way_of_a_search_is_the_same_from_result_and_record(
    analytic: ModuleType, tmp_path: Path
) -> None:
    study = optimize(
        analytic.AnalyticModel(), "R01", method="de", budget=200, folder=tmp_path / "s"
    )
    assert study.result is not None
    one = SearchPath.of(study.result, "differential-evolution", "D")
    two = SearchPath.from_study(Study.open(tmp_path / "s", model=analytic.AnalyticModel()), "D")
    for field in ("designs", "values", "evaluations"):
        np.testing.assert_array_equal(getattr(one, field), getattr(two, field))
    assert (one.label, one.method) == (two.label, two.method)


def test_figures_show_what_there_is(analytic: ModuleType, tmp_path: Path) -> None:
    model = analytic.AnalyticModel()
    plane = landscape(model, "R01", grid=21)
    ways = []
    for name in ("pattern-search", "levenberg-marquardt"):
        study = optimize(model, "R01", method=name, start=[0.011, 0.011], budget=60)
        assert study.result is not None
        ways.append(SearchPath.of(study.result, name, name[0].upper()))
    figure = plot.landscape(plane, ways)
    labels = {text.get_text() for text in figure.legends[0].get_texts()}
    assert {"snaps or bifurcations", "failed", "pattern search: end"} <= labels
    space, plan = figure.axes[:2]
    for axes in (space, plan):
        assert (axes.get_xlabel(), axes.get_ylabel()) == ("$R_{0}$ / cm", "$R_{1}$ / cm")
    star = [line for line in plan.lines if line.get_marker() == "*"]
    np.testing.assert_allclose(
        [star[0].get_xdata()[0], star[0].get_ydata()[0]], plane.minimum.vector * 100.0
    )
    dots = plan.collections[-1].get_offsets()
    assert len(dots) == int(((plane.events > 0) & ~plane.failed).sum())
    plot.save(figure, tmp_path / "plane.png")
    line = plot.landscape(landscape(model, "L", "f_exo", grid=21))
    assert line.axes[0].get_ylabel() == "$f_{exo}$ / N"
    plot.save(line, tmp_path / "line.svg")
    desert = landscape(model, "R01", grid=5, bounds={"R_1": (0.004, 0.0044)}, start=[0.006, 0.0042])
    assert desert.failed.all()
    plot.save(plot.landscape(desert), tmp_path / "desert.png")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"parameters": "L+R01"}, "has 3 parameters (L, R_0, R_1): choose one or two"),
        ({"axes": ["R_2"]}, 'unknown parameter of the set R01 "R_2" (did you mean "R_1"?)'),
        ({"axes": ["R_0", "R_0"]}, "one or two different parameters, got R_0, R_0"),
        ({"axes": []}, "one or two different parameters, got none"),
        ({"grid": 1}, "grid is 1: it must be at least 2."),
        ({"grid": 2.5}, "grid is 2.5: it must be an integer of at least 2."),
        ({"progress": 3}, "progress is 3: it must be a function."),
        ({"grid": 3000}, "has 9e+06 designs: at most 4,000,000"),
        ({"parameters": "R02"}, 'unknown parameter set "R02"'),
        ({"objective": "bendng"}, 'did you mean "bending"?'),
        ({"start": [0.1, 0.2]}, "start of R01: R_0 = 10 cm is outside its bounds"),
    ],
)
def test_bad_input_is_one_sentence(
    analytic: ModuleType, arguments: dict[str, Any], said: str
) -> None:
    with pytest.raises(InputError) as refusal:
        landscape(analytic.AnalyticModel(), **{"parameters": "R01", **arguments})
    assert said in str(refusal.value)
    assert str(refusal.value).endswith(".")


def test_a_study_that_is_no_landscape(analytic: ModuleType, tmp_path: Path) -> None:
    study = optimize(analytic.AnalyticModel(), "R01", budget=5, folder=tmp_path / "s")
    with pytest.raises(InputError, match="is not a landscape"):
        Landscape.of(study)
    with pytest.raises(InputError, match="is not a landscape: it is a study"):
        Landscape.open(tmp_path / "s")


@pytest.fixture(scope="module")
def constrained() -> Landscape:
    """Return a landscape of the pneumatic finger, a part of which is infeasible."""
    import flexor

    varied = {"exosuit.length": ("8 cm", "11 cm"), "exosuit.section.wall": ("1.5 mm", "3 mm")}
    return landscape(
        flexor.load("pneumatic-finger"),
        varied,
        "maximise range-of-motion",
        subject_to=["overlap <= 1 mm"],
        grid=7,
    )


def test_constraints_of_a_landscape(constrained: Landscape, tmp_path: Path) -> None:
    """Each design has the value and the excess of each; the best is feasible."""
    found = constrained
    assert found.constraints == ("strain-use <= 1", "min-stretch >= 0.1", "overlap <= 1 mm")
    over = found.constraint_values[..., 2] - 1e-3
    np.testing.assert_allclose(found.excesses[..., 2], over / 1e-3)
    np.testing.assert_array_equal(found.infeasible, over > 0.0)
    assert 0 < found.infeasible.sum() < found.infeasible.size
    assert not found.infeasible[found.minimum_index]
    assert found.minimum.feasible
    feasible = np.where(found.infeasible, np.inf, found.value)
    assert found.minimum.value == feasible.min() > found.value.min()
    assert all(not found.infeasible[tuple(at)] for at in found.local_minima())
    found.save(tmp_path)
    with open(tmp_path / "landscape.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[0]["overlap <= 1 mm"]) == found.constraint_values[0, 0, 2]
    assert "exosuit.section.wall [m]" in rows[0]
    arrays = np.load(tmp_path / "landscape.npz")
    np.testing.assert_array_equal(arrays["violation"], found.violation)


def test_the_figure_shades_what_is_infeasible(constrained: Landscape, tmp_path: Path) -> None:
    """And draws a line where the constraint that decides is active, and no other."""
    figure = plot.landscape(constrained)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "infeasible" in labels
    assert [each for each in labels if "active" in each] == ["overlap ≤ 1 mm is active"]
    assert any(each.startswith("best at exosuit.length = ") for each in labels)
    assert figure.axes[0].get_zlabel() == "range-of-motion / deg"
    plot.save(figure, tmp_path / "plane.png")
    line = landscape(
        constrained.problem.model,
        {"exosuit.section.wall": ("1.5 mm", "3 mm")},
        "maximise range-of-motion",
        subject_to=["overlap <= 1.2 mm"],
        start=[0.003],
        grid=7,
    )
    over = np.flatnonzero(line.infeasible)
    drawn = plot.landscape(line)
    crossings = [each for each in drawn.axes[0].lines if len(set(each.get_xdata())) == 1]
    assert 0 < len(over) < 7
    inside = [each.get_xdata()[0] for each in crossings if each.get_linewidth() == 1.2]
    low, high = line.axes[0][over.max()] * 1e3, line.axes[0][over.max() + 1] * 1e3
    assert any(low <= at <= high for at in inside)
