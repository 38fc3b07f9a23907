"""Studies with several objectives."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.model import Model
from flexor.study import Study
from flexor.viewer.share import shared_designs

VARIED = {"exosuit.section.wall": ("1.5 mm", "3 mm"), "exosuit.radius.base": ("6 mm", "10 mm")}
AIMS = ["maximise range-of-motion", "minimise mass"]
SMALL = {"population": 8, "generations": 4, "descents": 6, "iterations": 4}


@pytest.fixture(scope="module")
def model() -> Model:
    """Return the pneumatic finger."""
    return flexor.load("pneumatic-finger")


@pytest.fixture(scope="module")
def study(model: Model, tmp_path_factory: pytest.TempPathFactory) -> Study:
    """Return a small study in a folder."""
    return flexor.optimize(
        model,
        VARIED,
        AIMS,
        subject_to=["overlap <= 1.5 mm"],
        method_options=SMALL,
        folder=tmp_path_factory.mktemp("front") / "study",
    )


def test_a_page_of_a_front_calls_its_ends_what_they_are(study: Study) -> None:
    front, shown = study.front, shared_designs(study)
    assert [each.title for each in shown] == [
        "point 1 of the front, to maximise range-of-motion",
        f"point {len(front)} of the front, to minimise mass",
        "start",
    ]
    for each, row in zip(shown, (0, len(front) - 1), strict=False):
        values = [value for _, value, _ in each.parameters]
        expected = front.designs[row] / study.problem.parameters.scale
        np.testing.assert_allclose(values, expected, rtol=1e-12)


def test_no_design_is_better_than_one_of_the_front(study: Study) -> None:
    """In all objectives, among all feasible ones; the front is feasible and ordered."""
    front, record = study.front, study.record.outcomes()
    feasible = record.objective_values[record.violation == 0.0]
    assert len(front) > 5
    for values in front.values:
        assert not np.any(np.all(feasible < values, axis=1))
    assert np.all(np.diff(front.values[:, 0]) > 0.0)
    assert np.all(np.diff(front.values[:, 1]) < 0.0)
    assert all(front[i].feasible for i in range(len(front)))


def test_values_are_those_of_each_objective_alone(study: Study, model: Model) -> None:
    """And the best of the study is that of the first."""
    front = study.front
    for index, aim in enumerate(AIMS):
        problem = flexor.study.Problem.of(model, VARIED, aim)
        assert np.array_equal(problem.evaluate(front.designs).value, front.values[:, index])
    assert study.best.value == front.values[0, 0]
    assert front.headings == ("range-of-motion / deg", "mass / g")
    assert front.shown[0, 0] == study.best.shown


def test_refining_finds_more_than_the_population(study: Study, model: Model) -> None:
    """The hypervolume grows by the searches with gradients."""
    reference, front = [0.0, 0.03], study.front
    rows = slice(0, 32)
    values = study.record.outcomes().objective_values[rows]
    good = study.record.outcomes().violation[rows] == 0.0
    from pymoo.indicators.hv import HV

    before = HV(ref_point=np.array(reference))(values[good])
    assert front.hypervolume(reference) > 1.01 * before


def test_a_point_is_a_model_file(study: Study, tmp_path: Path) -> None:
    """Which gives the same values when it is loaded."""
    point = study.front.point(2)
    file = tmp_path / "point.toml"
    file.write_text(point.model.to_toml(), encoding="utf-8")
    path = flexor.load(file).equilibrium()
    angle = np.degrees(path.joint_angles[-1].sum() - path.joint_angles[0].sum())
    assert angle == pytest.approx(point.shown, rel=1e-9)


def test_the_folder_has_all_of_it(study: Study) -> None:
    """Opened, resumed and run again it is the same."""
    assert study.folder is not None
    again = Study.open(study.folder)
    assert again.problem.objective.name == "maximise range-of-motion, minimise mass"
    assert again.front.values.tobytes() == study.front.values.tobytes()
    again.close()
    study.front.save(study.folder)
    with open(study.folder / "front.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(study.front)
    assert float(rows[0]["exosuit.section.wall / m"]) == study.front.designs[0, 0]
    assert flexor.study.rerun(study.folder).difference is None
    least = flexor.load(study.folder / "optimum-mass.toml")
    assert least.hash == study.front[int(study.front.values[:, 1].argmin())].model.hash


def test_tables_have_the_points_that_figures_number(study: Study) -> None:
    many = replace(study.front, designs=np.zeros((57, 2)))
    assert set(many.spread(5)) <= set(many.spread(40)) < set(range(57))
    assert many.spread(57) == list(range(57))


def test_a_killed_run_is_resumed(study: Study, model: Model, tmp_path: Path) -> None:
    """To the same front."""

    class Killed(BaseException):
        pass

    def kill(at: flexor.study.StudyProgress) -> None:
        if at.evaluations > 40:
            raise Killed

    words = {"subject_to": ["overlap <= 1.5 mm"], "method_options": SMALL}
    folder = tmp_path / "killed"
    with pytest.raises(Killed):
        flexor.optimize(model, VARIED, AIMS, folder=folder, progress=kill, **words)
    done = flexor.study.resume(folder)
    assert done.front.values.tobytes() == study.front.values.tobytes()


def test_a_designed_model_of_a_parameter_set() -> None:
    """Length and linear radius exactly, other radii as samples."""
    model = flexor.load("finger")
    straight = flexor.optimize(model, "L+R01", budget=5).best
    path = straight.model.equilibrium([0, 1, 2, 3, 4, 5])
    assert path.joint_angles[-1] == pytest.approx(straight.joint_angles[-1], rel=1e-9)
    curved = flexor.optimize(model, "Rsc", budget=5).best
    path = curved.model.equilibrium([0, 1, 2, 3, 4, 5])
    assert path.joint_angles[-1] == pytest.approx(curved.joint_angles[-1], rel=1e-3)


def test_nothing_feasible_gives_an_empty_front(model: Model) -> None:
    """It is said when a point is asked for."""
    study = flexor.optimize(
        model, VARIED, AIMS, subject_to=["overlap <= 0.001 mm"], method_options=SMALL
    )
    assert len(study.front) == 0
    assert study.finished == "no design that was tried keeps the constraints"
    with pytest.raises(InputError, match="the front is empty"):
        study.front.point(1)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"objective": ["minimise mass", "minimise mass"]}, "is an objective twice"),
        ({"objective": ["minimise mass", "maximise mass"]}, '"mass" is an objective twice'),
        ({"objective": []}, "name at least one objective"),
        ({"objective": AIMS, "method": "auto"}, "method auto takes one objective"),
        ({"objective": AIMS[0], "method": "pareto"}, "method pareto needs several objectives"),
        ({"objective": ["minimise mas", AIMS[0]]}, 'did you mean "mass"'),
    ],
)
def test_bad_objectives(words: dict[str, object], message: str, model: Model) -> None:
    """Each is one clear sentence."""
    with pytest.raises(InputError, match=message):
        flexor.optimize(model, VARIED, budget=5, **words)  # type: ignore[arg-type]


def test_landscapes_and_comparisons_are_of_one_objective(model: Model) -> None:
    """Said before anything is evaluated."""
    several = flexor.objectives.objective(AIMS, model)
    with pytest.raises(InputError, match="a landscape shows one objective"):
        flexor.landscape(model, VARIED, several)
    with pytest.raises(InputError, match="takes one objective"):
        flexor.compare(model, VARIED, several, methods="auto", seeds=1, budget=2)
