"""Interrupted studies end where uninterrupted ones do; folders that cannot be used say so."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from flexor.design import custom
from flexor.errors import InputError
from flexor.objectives import custom as custom_objective
from flexor.optimizers import Budget
from flexor.store import Lock
from flexor.study import Record, Study, StudyProgress, optimize, resume

OPTIONS: dict[str, Any] = {"seed": 3, "method_options": {"starts": 4, "tolerance": 1e-3}}


def content(study: Study) -> tuple[Any, ...]:
    outcomes = study.record.outcomes()
    assert study.result is not None
    return (
        study.record.designs().tobytes(),
        outcomes.value.tobytes(),
        outcomes.joint_angles.tobytes(),
        outcomes.reason.tolist(),
        study.result.design.tobytes(),
        study.result.improvement_evaluations.tolist(),
        study.result.reason,
    )


class Killed(BaseException):
    pass


def interrupt_at(batch: int) -> Any:
    def before(model: Any) -> None:
        if len(model.calls) == batch:
            raise Killed

    return before


@pytest.mark.parametrize("seed", range(4))
def test_interrupted_anywhere_it_ends_in_the_same_record(
    analytic: ModuleType, tmp_path: Path, seed: int
) -> None:
    whole = optimize(analytic.AnalyticModel(), folder=tmp_path / "whole", **OPTIONS)
    random = np.random.default_rng(seed)
    began, calls, rounds = False, 0, 0
    while True:
        model = analytic.AnalyticModel()
        model.before_batch = interrupt_at(int(random.integers(0, 15)))
        try:
            pieces = optimize(model, folder=tmp_path / "pieces", resume=began, **OPTIONS)
            break
        except Killed:
            began, rounds = True, rounds + 1
            calls += sum(model.calls)
    assert rounds >= 2
    assert content(pieces) == content(whole)


def test_nothing_is_evaluated_twice(analytic: ModuleType, tmp_path: Path) -> None:
    first, again = analytic.AnalyticModel(), analytic.AnalyticModel()
    first.before_batch = interrupt_at(20)
    with pytest.raises(Killed):
        optimize(first, folder=tmp_path / "s", **OPTIONS)
    told: list[StudyProgress] = []
    study = optimize(again, folder=tmp_path / "s", resume=True, progress=told.append, **OPTIONS)
    check = 1  # the best recorded design is evaluated once more, to see that nothing has changed
    assert sum(first.calls) + sum(again.calls) - check == study.evaluations
    assert told[-1].replayed == sum(first.calls)
    assert told[-1].evaluated == sum(again.calls) - check
    third = analytic.AnalyticModel()
    assert content(optimize(third, folder=tmp_path / "s", resume=True, **OPTIONS))
    assert sum(third.calls) == check


def test_resume_needs_only_the_folder_and_may_go_further(
    analytic: ModuleType, tmp_path: Path
) -> None:
    short = optimize(analytic.AnalyticModel(), folder=tmp_path / "s", budget=30, **OPTIONS)
    assert short.evaluations == 30
    short.close()
    longer = resume(tmp_path / "s", model=analytic.AnalyticModel(), budget=60)
    assert longer.evaluations == 60
    longer.close()
    again = resume(tmp_path / "s", model=analytic.AnalyticModel())
    assert again.evaluations == 60
    again.close()
    end = resume(tmp_path / "s", model=analytic.AnalyticModel(), budget=Budget())
    assert content(end) == content(optimize(analytic.AnalyticModel(), **OPTIONS))


def test_random_starts_and_other_bounds_resume(analytic: ModuleType, tmp_path: Path) -> None:
    given: dict[str, Any] = {"start": "random", "bounds": {"L": (0.05, 0.2)}, "force": [0, 5]}
    whole = optimize(analytic.AnalyticModel(), "L+R01", "f_exo", **given, **OPTIONS)
    model = analytic.AnalyticModel()
    model.before_batch = interrupt_at(10)
    with pytest.raises(Killed):
        optimize(model, "L+R01", "f_exo", folder=tmp_path / "s", **given, **OPTIONS)
    assert content(resume(tmp_path / "s", model=analytic.AnalyticModel())) == content(whole)


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_a_killed_process_loses_nothing_that_was_recorded(
    analytic: ModuleType, tmp_path: Path
) -> None:
    program = [sys.executable, str(Path(__file__).with_name("analytic.py")), str(tmp_path / "s")]
    for attempt in range(3):
        arguments = program + (["--resume"] if attempt else [])
        process = subprocess.Popen(arguments, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        grown = 25 * (attempt + 1)
        while process.poll() is None:
            time.sleep(0.01)
            try:
                reader = Record(tmp_path / "s" / "record.sqlite", write=False)
            except InputError:
                continue  # not there yet
            if len(reader) >= grown:
                process.send_signal(signal.SIGKILL)
                reader.close()
                break
            reader.close()
        assert process.wait() == -signal.SIGKILL, process.stderr.read()  # type: ignore[union-attr]
        process.stderr.close()  # type: ignore[union-attr]
    with pytest.raises(InputError, match="holds recorded work already"):
        optimize(analytic.AnalyticModel(), folder=tmp_path / "s", **OPTIONS)
    study = optimize(analytic.AnalyticModel(), folder=tmp_path / "s", resume=True, **OPTIONS)
    assert content(study) == content(optimize(analytic.AnalyticModel(), **OPTIONS))


def test_two_processes_cannot_run_one_study(analytic: ModuleType, tmp_path: Path) -> None:
    refusals: list[str] = []
    here = os.getpid()

    def intrude(model: Any) -> None:
        if len(model.calls) == 3:
            with pytest.raises(InputError) as refusal:
                optimize(analytic.AnalyticModel(), folder=tmp_path / "s", resume=True, **OPTIONS)
            refusals.append(str(refusal.value))
            with pytest.raises(KeyError):  # reading is allowed meanwhile
                Study.open(tmp_path / "s", model=analytic.AnalyticModel()).settings.values["x"]

    model = analytic.AnalyticModel()
    model.before_batch = intrude
    optimize(model, folder=tmp_path / "s", **OPTIONS)
    said = f'the study "{tmp_path / "s"}" is in use by another process (process {here})'
    assert refusals == [f"{said}: wait for it or stop it."]
    Lock(tmp_path / "s", "study").release()


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"seed": 4}, "was made with seed = 3, not 4"),
        (
            {"method_options": {"starts": 5, "tolerance": 1e-3}},
            "was made with method.options.starts = 4, not 5",
        ),
        ({"parameters": "R01"}, 'was made with parameters.name = "L+R01", not "R01"'),
        ({"objective": "f_exo"}, 'was made with objective.name = "bending", not "tip-force"'),
        ({"bounds": {"L": (0.05, 0.2)}}, "was made with parameters.lower = "),
        ({"start": "random"}, "was made with start = [[0.1, 0.0116, 0.008]], not nothing"),
        ({"engine_options": {"tolerance": 1.0}}, "was made with engine.tolerance = nothing"),
    ],
)
def test_other_settings_are_refused(
    analytic: ModuleType, tmp_path: Path, changed: dict[str, Any], said: str
) -> None:
    optimize(analytic.AnalyticModel(), folder=tmp_path / "s", budget=5, **OPTIONS).close()
    with pytest.raises(InputError) as refusal:
        optimize(
            analytic.AnalyticModel(), folder=tmp_path / "s", resume=True, **{**OPTIONS, **changed}
        )
    assert said in str(refusal.value)
    with pytest.raises(InputError, match="with a model that differs from the one now"):
        optimize(analytic.AnalyticModel(hash="9999"), folder=tmp_path / "s", resume=True, **OPTIONS)


def test_own_functions_must_be_given_and_be_the_same(analytic: ModuleType, tmp_path: Path) -> None:
    def line(p: np.ndarray, X: np.ndarray) -> np.ndarray:
        return p[0] + p[1] * X

    def other(p: np.ndarray, X: np.ndarray) -> np.ndarray:
        return p[0] + 0.5 * p[1] * X

    def make(profile: Any) -> Any:
        return custom("line", ["R", "t"], [0.006, 0.0], [0.01, 0.002], [0.007, 0.001], profile)

    wanted = custom_objective("first", lambda path: -float(path.joint_angles[-1, 0]))
    model = analytic.AnalyticModel()
    optimize(model, make(line), wanted, folder=tmp_path / "s", budget=20).close()
    with pytest.raises(InputError, match='uses parameters "line", which Flexor does not know'):
        resume(tmp_path / "s", model=model)
    with pytest.raises(InputError, match='uses objective "first", which Flexor does not know'):
        resume(tmp_path / "s", model=model, parameters=make(line))
    with pytest.raises(InputError, match="no longer reproduces: it recorded"):
        resume(tmp_path / "s", model=model, parameters=make(other), objective=wanted)
    study = resume(tmp_path / "s", model=model, parameters=make(line), objective=wanted, budget=40)
    assert study.evaluations == 40


CHANGES: dict[str, dict[str, Any]] = {
    "future": {"format": 4},
    "one bound": {
        "parameters": {"name": "L", "labels": ["L"], "units": ["cm"], "lower": [], "upper": [1.0]}
    },
    "no budget": {"budget": 7},
    "odd start": {"start": "nowhere"},
    "odd options": {"method": {"name": "pattern-search", "options": [3]}},
}


def break_folder(folder: Path, kind: str) -> None:
    settings = folder / "settings.json"
    if kind == "gone":
        shutil.rmtree(folder)
    elif kind == "empty":
        shutil.rmtree(folder)
        folder.mkdir()
    elif kind == "file":
        shutil.rmtree(folder)
        folder.write_text("not a folder")
    elif kind == "not json":
        settings.write_text("{")
    elif kind == "nested":
        settings.write_text("[" * 100_000)
    elif kind == "no text":
        settings.write_text(settings.read_text().replace('"flexor": "', '"flexor": "\\ud800'))
    elif kind == "not utf-8":
        settings.write_bytes(b"\xff\xfe\x00")
    elif kind == "list":
        settings.write_text("[1, 2]")
    elif kind == "half":
        settings.write_text('{"format": 3, "model": {"name": "x"}}')
    elif kind in CHANGES:
        settings.write_text(json.dumps({**json.loads(settings.read_text()), **CHANGES[kind]}))
    elif kind == "first":
        settings.write_text('{"format": 1, "flexor": "0.1.0"}')
    elif kind == "comparison":
        settings.write_text('{"format": 3, "kind": "comparison"}')
    elif kind == "linked":
        settings.rename(folder / "elsewhere.json")
        settings.symlink_to("elsewhere.json")
    elif kind == "pipe":
        settings.unlink()
        os.mkfifo(settings)
    elif kind == "no record":
        (folder / "record.sqlite").unlink()
    elif kind == "broken record":
        (folder / "record.sqlite").write_bytes(b"garbage" * 1000)
    elif kind == "other record":
        (folder / "record.sqlite").unlink()
        Record(folder / "record.sqlite", (7, 2, 1)).close()


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        ("gone", "is not a study: there is no such folder"),
        ("empty", "is not a study: it has no settings.json"),
        ("file", "is not a study: it is a file"),
        ("not json", "is damaged: it is not the settings of a study"),
        ("nested", "is damaged: it is not the settings of a study"),
        ("no text", "is damaged: it is not the settings of a study"),
        ("not utf-8", "is damaged: it is not the settings of a study"),
        ("list", "is damaged: it is not the settings of a study"),
        ("half", "is damaged: it is not the settings of a study"),
        ("one bound", "is damaged: it is not the settings of a study"),
        ("no budget", "is damaged: it is not the settings of a study"),
        ("odd start", "is damaged: it is not the settings of a study"),
        ("odd options", "is damaged: it is not the settings of a study"),
        ("future", "has format 4; this version of Flexor reads format 3"),
        ("first", "has format 1; this version of Flexor reads format 3: use the version that"),
        ("comparison", '" is not a study: it is a comparison.'),
        ("linked", 'settings.json" is not a regular file: it is a link'),
        ("pipe", 'settings.json" is not a regular file: it is a special file'),
        ("no record", "is damaged: it has no record.sqlite"),
        ("broken record", "cannot be used: file is not a database"),
        ("other record", "is damaged: its record.sqlite is of another study"),
    ],
)
def test_a_folder_that_cannot_be_used_is_one_clear_sentence(
    analytic: ModuleType, tmp_path: Path, kind: str, said: str
) -> None:
    folder = tmp_path / "s"
    optimize(analytic.AnalyticModel(), folder=folder, budget=5, **OPTIONS).close()
    break_folder(folder, kind)
    model = analytic.AnalyticModel()
    for attempt in (
        lambda: resume(folder, model=model),
        lambda: optimize(model, folder=folder, resume=True, **OPTIONS),
        lambda: Study.open(folder, model=model),
    ):
        with pytest.raises(InputError) as refusal:
            attempt()
        assert said in str(refusal.value)
        assert "\n" not in str(refusal.value)
        assert str(refusal.value).endswith(".")


@pytest.mark.parametrize("table", ["objective", "parameters"])
def test_names_without_end_are_not_quoted_at_length(
    analytic: ModuleType, tmp_path: Path, table: str
) -> None:
    optimize(analytic.AnalyticModel(), folder=tmp_path / "s", budget=5, **OPTIONS).close()
    settings = tmp_path / "s" / "settings.json"
    values = json.loads(settings.read_text())
    values[table]["name"] = "a" * 5000
    settings.write_text(json.dumps(values))
    with pytest.raises(InputError, match=r"which Flexor does not know: give it as") as refusal:
        Study.open(tmp_path / "s", model=analytic.AnalyticModel())
    assert len(str(refusal.value)) < 400


def test_places_that_are_taken_or_cannot_be_written(analytic: ModuleType, tmp_path: Path) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.tex").write_text("precious")
    with pytest.raises(InputError, match=r'full" is not an empty folder'):
        optimize(analytic.AnalyticModel(), folder=tmp_path / "full", budget=1)
    with pytest.raises(InputError, match="cannot be made: "):
        optimize(analytic.AnalyticModel(), folder=tmp_path / "full" / "thesis.tex" / "s", budget=1)
    assert [file.name for file in (tmp_path / "full").iterdir()] == ["thesis.tex"]
    (tmp_path / "empty").mkdir()
    optimize(analytic.AnalyticModel(), folder=tmp_path / "empty", budget=1)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["empty", "full"]
