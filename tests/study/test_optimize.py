"""A whole optimisation on an analytic model: what is found, shown and refused."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from flexor import design
from flexor.errors import InputError
from flexor.objectives import custom
from flexor.optimizers import Budget, PatternSearch
from flexor.study import Study, StudyProgress, Threads, optimize


def test_the_optimum_is_found_and_everything_known_of_it(analytic: ModuleType) -> None:
    study = optimize(analytic.AnalyticModel(), "L+R01", "bending", method_options={"starts": 4})
    best, start = study.best, study.start
    assert best.parameters.keys() == {"L", "R_0", "R_1"}
    assert best.parameters["L"] == pytest.approx(0.11, abs=1e-5)
    assert start.parameters == {"L": 0.1, "R_0": 0.0116, "R_1": 0.008}
    assert best.value < start.value
    assert best.bending == pytest.approx(np.sum(best.joint_angles[-1]), rel=1e-15)
    assert best.shown == best.bending
    assert best.value == pytest.approx(np.linalg.norm(np.pi - best.joint_angles[-1]), rel=1e-14)
    np.testing.assert_array_equal(best.path.joint_angles, best.joint_angles)
    assert study.result is not None
    assert study.result.value == best.value
    np.testing.assert_array_equal(study.result.design, best.vector)
    assert study.evaluations == study.result.evaluations
    assert "L = 11 cm" in repr(best)


def test_table_and_comparison_agree_with_the_record(analytic: ModuleType) -> None:
    study = optimize(analytic.AnalyticModel(), seed=2, method_options={"starts": 6})
    table = study.table()
    assert all(len(column) == study.evaluations for column in table.values())
    failed = table["R_1"] < 0.0045
    assert 0 < failed.sum() < study.evaluations
    assert np.isnan(table["value"][failed]).all()
    assert np.isfinite(table["value"][~failed]).all()
    assert set(table["reason"][failed]) == {"did not converge at 3 N (iteration limit)"}
    assert set(table["reason"][~failed]) == {""}
    assert study.record.failures() == {"did not converge at 3 N (iteration limit)": failed.sum()}
    assert np.nanmin(table["value"]) == study.best.value
    np.testing.assert_array_equal(table["events"], (table["R_0"] < 0.005).astype(int))
    assert set(table["iterations"]) == {30}

    rows = {row.label: row for row in study.comparison()}
    assert rows["R_0"].unit == "cm"
    assert rows["R_0"].start == pytest.approx(1.16)
    assert rows["R_0"].best == pytest.approx(100 * study.best.parameters["R_0"])
    assert rows["bending"].best == study.best.bending
    assert rows["objective bending"].start == study.start.value


def test_objectives_other_than_bending_are_compared_too(analytic: ModuleType) -> None:
    study = optimize(analytic.AnalyticModel(), "R01", "f_exo")
    rows = {row.label: row for row in study.comparison()}
    assert rows["tip force"].unit == "N"
    assert rows["tip force"].best == pytest.approx(study.best.tip_force[-1])
    assert rows["tip force"].best > rows["tip force"].start


def test_own_sets_objectives_and_methods(analytic: ModuleType) -> None:
    bulge = design.custom(
        "bulge",
        ["R", "h"],
        [0.005, 0.0],
        [0.012, 0.003],
        [0.008, 0.001],
        lambda p, X: p[0] + p[1] * X * (1.0 - X),
        units=["cm", "mm"],
    )
    forces = []

    def second_joint(path: Any) -> float:
        forces.append(path.force)
        return -float(path.joint_angles[-1, 1])

    wanted = custom("second", second_joint, force=[0, 2, 4], quantity="second", unit="rad")
    search = PatternSearch(tolerance=1e-3)
    study = optimize(
        analytic.AnalyticModel(),
        design.union(design.parameter_set("L"), bulge),
        wanted,
        search,
        executor=Threads(1),
    )
    assert study.best.parameters["L"] == pytest.approx(0.11, abs=1e-3)
    assert study.best.joint_angles.shape == (3, 3)
    np.testing.assert_array_equal(forces[0], [0.0, 2.0, 4.0])
    # The rod of the model replaces the one the set was made with.
    wide = analytic.AnalyticModel()
    wide.design = analytic.Space(length=0.2, points=np.linspace(0, 1, 3))
    alone = optimize(wide, bulge, "bending", search)
    np.testing.assert_array_equal(alone.problem.geometry(alone.best.vector[None]).length, [0.2])


def test_a_surface_that_is_not_positive_fails_alone(analytic: ModuleType) -> None:
    def thin(p: np.ndarray, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        bad = np.nan if p[0] > 0.009 else p[0]
        return np.full(X.shape, bad), np.zeros(X.shape)

    chosen = design.custom("thin", ["R"], [0.005], [0.012], [0.007], thin)
    study = optimize(analytic.AnalyticModel(), chosen, start=[[0.007], [0.0115]])
    table = study.table()
    np.testing.assert_array_equal(np.isnan(table["value"]), table["R"] > 0.009)
    assert list(study.record.failures()) == ["has a length or radius that is not positive"]


def test_a_desert_has_no_best_design(analytic: ModuleType) -> None:
    study = optimize(analytic.AnalyticModel(), "R01", bounds={"R_1": (0.004, 0.0044)},
                     start=[0.0116, 0.0042], budget=50)  # fmt: skip
    with pytest.raises(InputError, match="no design of the study succeeded: did not converge"):
        _ = study.best
    assert np.isinf(study.start.value)


def test_budget_seed_start_and_force_are_heard(analytic: ModuleType) -> None:
    assert optimize(analytic.AnalyticModel(), budget=37).evaluations == 37
    assert optimize(analytic.AnalyticModel(), budget=Budget(evaluations=5)).evaluations == 5
    drawn = [optimize(analytic.AnalyticModel(), start="random", seed=s, budget=1) for s in (1, 2)]
    assert not np.array_equal(drawn[0].best.vector, drawn[1].best.vector)
    study = optimize(analytic.AnalyticModel(), "L", start=[0.08], force=[0.0, 10.0], budget=1)
    assert study.best.vector.tolist() == [0.08]
    assert study.best.joint_angles.shape == (2, 3)


def test_progress_tells_the_best_and_what_remains(analytic: ModuleType) -> None:
    told: list[StudyProgress] = []
    study = optimize(analytic.AnalyticModel(), budget=100, progress=told.append)
    assert [at.iteration for at in told] == list(range(len(told)))
    assert told[-1].best is not None
    assert told[-1].best.value == study.best.value
    assert all(at.evaluated == at.evaluations and at.replayed == 0 for at in told)
    assert all(at.remaining is not None and at.remaining <= 100 - at.evaluations for at in told)
    assert told[-1].rate > 0
    assert told[-1].seconds_left is not None


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"parameters": "L+R10"}, 'unknown parameter set "R10" (did you mean "R01"?)'),
        ({"objective": "bendng"}, 'unknown objective "bendng" (did you mean "bending"?)'),
        ({"method": "patternsearch"}, 'did you mean "pattern-search"?'),
        ({"start": [0.1, 0.02, 0.008]}, "start of L+R01: R_0 = 2 cm is outside its bounds"),
        ({"start": [0.1, 0.008]}, "L+R01 has 3 parameters (L, R_0, R_1)"),
        ({"start": "ranom"}, 'start is "ranom": L+R01 needs 3 values'),
        ({"bounds": {"R_1": (0.004, 0.007)}}, "give a start within them, or random"),
        ({"bounds": {"R_1": (0.004, 0.007)}}, "the model's own exosuit as start of L+R01: R_1"),
        ({"budget": 0}, "budget is 0: it must be at least 1"),
        ({"resume": True}, "resuming a study needs its folder"),
        ({"method": 3}, "method is 3: it must be the name of a method"),
        ({"subject_to": [3]}, "subject_to has 3: each must be a text"),
        ({"without": 3}, "without is 3: it must be a sequence of texts"),
        ({"method": PatternSearch(), "method_options": {"starts": 2}}, "given with its name"),
    ],
)
def test_bad_input_is_one_sentence(
    analytic: ModuleType, arguments: dict[str, Any], said: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError) as refusal:
        optimize(analytic.AnalyticModel(), **arguments)
    assert said in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert str(refusal.value).endswith(".")


def test_study_in_memory_and_in_a_folder_are_the_same(analytic: ModuleType, tmp_path: Path) -> None:
    kept = optimize(analytic.AnalyticModel(), seed=1, folder=tmp_path / "a" / "study")
    memory = optimize(analytic.AnalyticModel(), seed=1)
    for label, column in memory.table().items():
        if column.dtype == object:
            assert column.tolist() == kept.table()[label].tolist()
        else:
            np.testing.assert_array_equal(column, kept.table()[label])
    assert memory.folder is None
    opened = Study.open(tmp_path / "a" / "study", model=analytic.AnalyticModel())
    assert opened.best.vector.tolist() == kept.best.vector.tolist()
    assert opened.finished == "the mesh is below 1e-06"
    assert (tmp_path / "a" / "study" / "model.toml").read_text() == 'name = "analytic"\n'


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("fingre", "L", "bending"), 'unknown preset "fingre" (did you mean "finger"?)'),
        ((None, "L", "bending"), "model is None: expected a Model"),
        (("model", None, "bending"), "parameter set is None: expected a name"),
        (
            ("model", "L", len),
            "objective is <built-in function len>: expected a name or an objective",
        ),
    ],
)
def test_things_of_another_kind_are_refused(
    analytic: ModuleType, arguments: tuple[Any, Any, Any], sentence: str
) -> None:
    model, parameters, objective = arguments
    given = analytic.AnalyticModel() if model == "model" else model
    with pytest.raises(InputError) as caught:
        optimize(given, parameters, objective)
    assert sentence in str(caught.value)
