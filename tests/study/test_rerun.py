"""A study run again from its folder is the same to the last bit, or says what is not."""

from __future__ import annotations

import json
import sqlite3
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.optimizers import Budget
from flexor.study import Rerun, Study, Threads, optimize, rerun

OPTIONS: dict[str, Any] = {"seed": 3, "method_options": {"starts": 4, "tolerance": 1e-3}}


@pytest.mark.parametrize(
    ("method", "constants"),
    [
        ("pattern-search", "printed"),  # a path of snaps
        ("multistart-bfgs", "calibrated"),
        ("da", "calibrated"),
    ],
)
def test_every_bit_comes_again_on_any_number_of_threads(
    tmp_path: Path, method: str, constants: str
) -> None:
    model = flexor.load("finger", constants)
    made = optimize(
        model,
        "R01",
        method=method,
        start="random",
        seed=5,
        budget=12,
        folder=tmp_path / "s",
        executor=Threads(1),
    )
    made.close()
    found = rerun(tmp_path / "s", executor=Threads(2))
    assert found.same
    assert found.difference is None
    assert (found.evaluations, found.common, found.deviation, found.changed) == (12, 12, 0.0, ())
    assert found.study.best.vector.tobytes() == Study.open(tmp_path / "s").best.vector.tobytes()


def test_the_folder_is_only_read_and_the_new_study_is_like_it(
    analytic: ModuleType, tmp_path: Path
) -> None:
    optimize(analytic.AnalyticModel(), folder=tmp_path / "s", **OPTIONS).close()
    before = {file.name: file.read_bytes() for file in (tmp_path / "s").iterdir()}
    found = rerun(tmp_path / "s", into=tmp_path / "again", model=analytic.AnalyticModel())
    assert found.same
    found.study.close()
    after = {file.name: file.read_bytes() for file in (tmp_path / "s").iterdir()}
    assert {name: after[name] for name in before} == before
    settings = [json.loads((tmp_path / s / "settings.json").read_text()) for s in ("s", "again")]
    for each in settings:
        del each["created"]
    assert settings[0] == settings[1]
    assert rerun(tmp_path / "again", model=analytic.AnalyticModel()).same


def test_a_landscape_is_a_study_like_any_other(analytic: ModuleType, tmp_path: Path) -> None:
    flexor.landscape(analytic.AnalyticModel(), "R01", grid=4, folder=tmp_path / "s")
    assert rerun(tmp_path / "s", model=analytic.AnalyticModel()).evaluations == 16


class Killed(BaseException):
    pass


@pytest.mark.parametrize("how", ["killed", "seconds", "resumed with less"])
def test_a_study_that_did_not_end_by_itself_is_compared_as_far_as_it_went(
    analytic: ModuleType, tmp_path: Path, how: str
) -> None:
    model = analytic.AnalyticModel(pause=0.002)
    if how == "killed":

        def before(model: Any) -> None:
            if len(model.calls) == 20:
                raise Killed

        model.before_batch = before
        with pytest.raises(Killed):
            optimize(model, folder=tmp_path / "s", **OPTIONS)
    elif how == "seconds":
        optimize(model, folder=tmp_path / "s", budget=Budget(seconds=0.01), **OPTIONS).close()
    else:
        optimize(model, folder=tmp_path / "s", budget=40, **OPTIONS).close()
        optimize(model, folder=tmp_path / "s", budget=20, resume=True, **OPTIONS).close()
    recorded = Study.open(tmp_path / "s", model=model).evaluations
    found = rerun(tmp_path / "s", model=analytic.AnalyticModel())
    assert found.same
    assert found.evaluations == found.study.evaluations == recorded > 0


def changed(folder: Path, sql: str) -> None:
    inside = sqlite3.connect(folder / "record.sqlite")
    inside.execute(sql)
    inside.commit()
    inside.close()


@pytest.mark.parametrize(
    ("sql", "evaluation", "what"),
    [
        ("UPDATE evaluations SET iterations = 6 WHERE id = 7", 7, "iterations"),
        ("UPDATE evaluations SET value = value * (1 + 4e-16) WHERE id = 9", 9, "value"),
        ("UPDATE evaluations SET design = x'%s' WHERE id = 3" % ("01" * 24), 3, "design"),
        ("UPDATE evaluations SET reason = 'tired' WHERE id = 5", 5, "reason"),
        ("UPDATE evaluations SET stable = x'000101010101' WHERE id = 2", 2, "stable"),
        ("DELETE FROM evaluations WHERE id = 30", 0, "evaluations"),
        ("UPDATE about SET value = '\"bored\"' WHERE key = 'finished'", 0, "end"),
        (
            "UPDATE evaluations SET derivatives = zeroblob(96), regularity = 'regular' "
            "WHERE id = 4",
            4,
            "derivatives",
        ),
    ],
)
def test_one_bit_is_found(
    analytic: ModuleType, tmp_path: Path, sql: str, evaluation: int, what: str
) -> None:
    optimize(analytic.AnalyticModel(), folder=tmp_path / "s", budget=30, **OPTIONS).close()
    changed(tmp_path / "s", sql)
    found: Rerun = rerun(tmp_path / "s", model=analytic.AnalyticModel())
    assert not found.same
    assert found.difference is not None
    assert (found.difference.evaluation, found.difference.what) == (evaluation, what)
    assert found.difference.then != found.difference.now
    assert found.deviation < 1e-14
    assert found.changed == ()


def test_other_mechanics_and_versions_are_named(analytic: ModuleType, tmp_path: Path) -> None:
    optimize(analytic.AnalyticModel(), folder=tmp_path / "s", budget=9, **OPTIONS).close()
    path = tmp_path / "s" / "settings.json"
    values = json.loads(path.read_text())
    values["flexor"] = "0.0.9"
    values["environment"]["engine"] = "0" * 16
    values["environment"].pop("scipy")
    path.write_text(json.dumps(values))

    class Softer(analytic.AnalyticModel):  # type: ignore[misc, name-defined]
        def evaluate(self, *given: Any, **options: Any) -> Any:
            batch = super().evaluate(*given, **options)
            batch.joint_angles[...] *= 1.01
            return batch

    found = rerun(tmp_path / "s", model=Softer(hash="9999"))
    assert found.difference is not None
    assert (found.difference.evaluation, found.difference.what) == (1, "value")
    assert 1e-4 < found.deviation < 0.1
    then = {each.what: each.then for each in found.changed}
    assert then == {"flexor": "0.0.9", "model": "0123", "engine": "0" * 16, "scipy": None}


def test_nothing_to_run_again(analytic: ModuleType, tmp_path: Path) -> None:
    model = analytic.AnalyticModel()

    def never(model: Any) -> None:
        raise Killed

    model.before_batch = never
    with pytest.raises(Killed):
        optimize(model, folder=tmp_path / "s", **OPTIONS)
    with pytest.raises(InputError, match="has no evaluation that could be run again"):
        rerun(tmp_path / "s", model=analytic.AnalyticModel())
    with pytest.raises(InputError, match="is not a study: there is no such folder"):
        rerun(tmp_path / "nowhere")


def test_designs_that_fail_in_one_study_only(analytic: ModuleType, tmp_path: Path) -> None:
    optimize(analytic.AnalyticModel(), folder=tmp_path / "s", budget=30, **OPTIONS).close()
    changed(tmp_path / "s", "UPDATE evaluations SET value = NULL, shown = NULL WHERE id = 8")
    found = rerun(tmp_path / "s", model=analytic.AnalyticModel())
    assert found.difference is not None
    assert (found.difference.evaluation, found.difference.what) == (8, "value")
    assert np.isinf(found.deviation)
