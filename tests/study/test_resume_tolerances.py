"""Studies with tolerances take the same rounds however they are interrupted and resumed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import flexor
from flexor.model import Model
from flexor.model.reading import check
from flexor.study import Study, optimize, rerun, resume

VARIED = {"exosuit.section.wall": ("1.5 mm", "3 mm"), "middle.slack": ("0 mm", "1 mm")}
AIM = "maximise range-of-motion"
STATED: dict[str, Any] = {
    "tolerance": {"exosuit.section.wall": "0.1 mm", "exosuit.length": "0.5 mm"},
    "subject_to": ["overlap <= 1 mm"],
}


@pytest.fixture(scope="module")
def model() -> Model:
    document = flexor.load("pneumatic-finger").file.to_document()
    document["bodies"]["exosuit"]["elements"] = 8
    for name, place in (("proximal", 0.25), ("middle", 0.625), ("distal", 0.875)):
        document["straps"][name]["at"] = place
    return flexor.load(check(document))


def content(study: Study) -> list[Any]:
    return [
        (each.search, each.designs().tobytes(), each.outcomes().value.tobytes())
        for each in study.records
    ] + [study.finished, study.robust, study.best.vector.tobytes()]


@pytest.fixture(scope="module")
def whole(model: Model, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Any]]:
    """The folder of a study that was not interrupted, and its content."""
    folder = tmp_path_factory.mktemp("whole")
    study = optimize(model, VARIED, AIM, budget=60, folder=folder, **STATED)
    assert len(study.records) > 1
    assert study.evaluated == study.evaluations
    found = content(study)
    study.close()
    return folder, found


def test_a_finished_study_evaluates_nothing_when_it_is_resumed(
    whole: tuple[Path, list[Any]],
) -> None:
    again = resume(whole[0])
    assert again.evaluated == 0
    assert content(again) == whole[1]
    again.close()


@pytest.mark.parametrize("moment", [3, 8, 12])
def test_interrupted_in_any_round_it_ends_as_one_that_was_not(
    moment: int, model: Model, whole: tuple[Path, list[Any]], tmp_path: Path
) -> None:
    calls = 0

    def kill(_: object) -> None:
        nonlocal calls
        calls += 1
        if calls == moment:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        optimize(model, VARIED, AIM, budget=60, folder=tmp_path, progress=kill, **STATED)
    assert content(resume(tmp_path)) == whole[1]


def test_a_larger_budget_goes_on_and_can_be_run_again(model: Model, tmp_path: Path) -> None:
    """What was evaluated with the smaller budget is part of the study with the larger one."""
    first = optimize(model, VARIED, AIM, budget=12, folder=tmp_path, **STATED)
    count = first.evaluations
    rounds = [(each.search, each.designs().tobytes()) for each in first.records]
    first.close()
    more = resume(tmp_path, budget=40)
    assert 12 < more.evaluations <= 40
    assert more.evaluated == more.evaluations - count
    for (name, designs), record in zip(rounds, more.records, strict=False):
        assert record.search == name
        assert record.designs().tobytes().startswith(designs)
    found = content(more)
    more.close()
    again = resume(tmp_path)
    assert again.evaluated == 0
    assert content(again) == found
    again.close()
    repeated = rerun(tmp_path)
    assert repeated.same
    assert repeated.evaluations > count
