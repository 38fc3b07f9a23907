"""Discrete choices: all combinations are tried, and the best is known from trying each."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexor
from flexor.design import combinations
from flexor.errors import InputError
from flexor.model import Model
from flexor.model.changes import path_of
from flexor.model.reading import check
from flexor.study import Choices, choices, optimize, resume_choices

VARIED = {"exosuit.section.wall": ("1.5 mm", "3 mm"), "middle.slack": ("0 mm", "1 mm")}
CHOICES = {"exosuit.material": ["silicone", "ecoflex-00-50"], "middle": ["with", "without"]}
AIM = "maximise range-of-motion"


@pytest.fixture(scope="module")
def model() -> Model:
    document = flexor.load("pneumatic-finger").file.to_document()
    document["bodies"]["exosuit"]["elements"] = 8
    for name, place in (("proximal", 0.25), ("middle", 0.625), ("distal", 0.875)):
        document["straps"][name]["at"] = place
    return flexor.load(check(document))


TOLERANCED: dict[str, Any] = {
    "tolerance": {"exosuit.section.wall": "0.1 mm", "exosuit.length": "0.5 mm"},
    "subject_to": ["overlap <= 1 mm"],
    "budget": 90,
}


def everything(folder: Path) -> list[Any]:
    """Return the answer of choices, and every evaluation of each combination."""
    found = [(folder / name).read_text() for name in ("optimum.toml", "choices.json")]
    for each in sorted(folder.glob("?/record.sqlite")):
        with sqlite3.connect(f"file:{each}?mode=ro", uri=True) as record:
            columns = "search, design, value, violation, constraints, slopes"
            found += record.execute(f"SELECT {columns} FROM evaluations ORDER BY id").fetchall()
            found += record.execute("SELECT * FROM about ORDER BY key").fetchall()
    return found


def content(found: Choices) -> list[Any]:
    return [
        (each.name, each.rounds, each.rank, each.study.record.designs().tobytes())
        for each in found.tried
    ]


def test_the_best_is_that_of_searching_each(model: Model, tmp_path: Path) -> None:
    """Killed and resumed it ends in the same records; the model file has the combination."""
    whole = choices(model, VARIED, AIM, CHOICES, budget=60, folder=tmp_path / "whole")
    assert [each.rounds for each in whole.tried] == [3, 2, 1, 1]
    assert whole.evaluations <= 60
    shown = {}
    for each in combinations(CHOICES, model):
        there = each.values["middle"] == "with"
        varied = {k: v for k, v in VARIED.items() if there or not k.startswith("middle")}
        best = optimize(each.model, varied, AIM, budget=20).best
        shown[each.name] = best.violation, best.value
    assert whole.combination.name == min(shown, key=lambda name: shown[name])
    saved = flexor.load(tmp_path / "whole" / "optimum.toml")
    assert saved.title.endswith(f"({whole.combination.name})")
    assert saved.hash == whole.best.best.model.hash
    calls = 0

    def kill(_: object) -> None:
        nonlocal calls
        calls += 1
        if calls == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        choices(model, VARIED, AIM, CHOICES, budget=60, folder=tmp_path / "s", progress=kill)
    assert content(resume_choices(tmp_path / "s")) == content(whole)
    # Also where everything is known.
    assert content(resume_choices(tmp_path / "whole")) == content(whole)


def test_a_combination_that_cannot_be_searched_does_not_end_the_others(
    model: Model, tmp_path: Path
) -> None:
    """Without gravity and the strap nothing depends on the density and its slack."""
    given = {"proximal": ["without", "with"]}
    varied = {"proximal.slack": ("0 mm", "1 mm"), "exosuit.density": ("0 g/cm^3", "2 g/cm^3")}
    stated: tuple[Any, ...] = (model, varied, AIM, given)
    found = choices(*stated, budget=60, folder=tmp_path / "s")
    assert found.combination.name == "with proximal"
    assert list(found.failed) == ["without proximal"]
    again = resume_choices(tmp_path / "s")
    assert content(again) == content(found)
    assert again.failed == found.failed
    given = {"exosuit.material": ["silicone", "ecoflex-00-50"]}
    with pytest.raises(InputError, match=r"^exosuit.material silicone: .* none of the variables"):
        choices(model, {"exosuit.density": varied["exosuit.density"]}, AIM, given)


@pytest.fixture(scope="module")
def toleranced(model: Model, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("choices") / "whole"
    found = choices(model, VARIED, AIM, CHOICES, folder=folder, **TOLERANCED)
    assert found.evaluated == found.evaluations > 0
    # The search for a robust design has begun, or else a resumed one could not take another way.
    assert any("round 1" in each.search for each in found.best.records)
    found.close()
    return folder


def test_what_keeps_constraints_as_drawn_is_not_called_infeasible(model: Model) -> None:
    """Though errors within the tolerances break them, which only some searches have come to see."""
    stated = {**TOLERANCED, "budget": 6}
    found = choices(model, VARIED, AIM, CHOICES, **stated)
    assert any(each.violation > 0.0 for each in found.tried)
    for each in found.tried:
        broken = any(kept.excess > 0.0 for kept in each.study.best.kept)
        assert each.standing == (2 if broken else int(not each.robust))
    assert [each.standing for each in found.tried] == sorted(each.standing for each in found.tried)
    found.close()


def test_a_field_has_choices_or_bounds(model: Model) -> None:
    both = {"bodies.exosuit.section.wall": ["1.5 mm", "2 mm"]}
    with pytest.raises(InputError, match=r'"bodies\.exosuit\.section\.wall" has bounds'):
        choices(model, VARIED, AIM, both)


def test_finished_choices_evaluate_nothing_when_they_are_resumed(toleranced: Path) -> None:
    before = everything(toleranced)
    for _ in range(2):
        found = resume_choices(toleranced)
        assert found.evaluated == 0
        found.close()
    assert everything(toleranced) == before


@pytest.mark.parametrize("moment", [2, 9, 16])
def test_tolerances_do_not_change_what_interrupted_choices_find(
    moment: int, toleranced: Path, model: Model, tmp_path: Path
) -> None:
    calls = 0

    def kill(_: object) -> None:
        nonlocal calls
        calls += 1
        if calls == moment:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        choices(model, VARIED, AIM, CHOICES, folder=tmp_path, progress=kill, **TOLERANCED)
    found = resume_choices(tmp_path)
    assert 0 < found.evaluated <= found.evaluations
    found.close()
    assert everything(tmp_path) == everything(toleranced)


def test_choices_are_resumed_as_they_were_stated(toleranced: Path, model: Model) -> None:
    other = {**TOLERANCED, "subject_to": ["overlap <= 0.9 mm"]}
    with pytest.raises(InputError, match="made with another subject to"):
        choices(model, VARIED, AIM, CHOICES, folder=toleranced, resume=True, **other)


def test_what_there_is_not_does_not_vary(model: Model) -> None:
    found = {each.name: each for each in combinations(CHOICES, model)}
    assert list(found) == [
        "exosuit.material silicone, with middle",
        "exosuit.material silicone, without middle",
        "exosuit.material ecoflex-00-50, with middle",
        "exosuit.material ecoflex-00-50, without middle",
    ]
    bare = found["exosuit.material ecoflex-00-50, without middle"].model
    assert set(bare.file.straps) == {"proximal", "distal"}
    design = bare.file.design
    assert design is not None
    assert "middle.to.at" not in design.varied
    assert "middle.to.at" not in design.tolerance
    assert bare.file.rod("exosuit").material == "ecoflex-00-50-hoop"
    layers = combinations({"exosuit.section.layer": ["with", "without"]}, model)
    assert [each.model.file.rod("exosuit").section.layer is None for each in layers] == [
        False,
        True,
    ]


def test_a_wound_exosuit_stays_wound(model: Model) -> None:
    """As if the material had been stated in the file with the thread around it."""
    found = combinations({"exosuit.material": ["silicone", "ecoflex-00-50"]}, model)[1].model
    material = found.file.materials["ecoflex-00-50-hoop"]
    assert (material.library, material.winding) == ("ecoflex-00-50", "hoop")
    document = model.file.to_document()
    document["materials"]["soft"] = {"library": "ecoflex-00-50", "winding": "hoop"}
    document["bodies"]["exosuit"]["material"] = "soft"
    by_hand = flexor.load(check(document))
    assert np.array_equal(
        found.equilibrium().joint_angles, by_hand.equilibrium().joint_angles, equal_nan=True
    )
    assert not any("widens" in each for each in found.equilibrium().warnings)
    # What is stated in the file is taken as it is stated, and so are layers and skins.
    document["materials"]["soft"]["winding"] = "none"
    stated = flexor.load(check(document))
    for field, value, name in (
        ("exosuit.material", "silicone", "silicone"),
        ("exosuit.section.layer.material", "dragon-skin-30", "dragon-skin-30"),
        ("exosuit.skin.material", "ecoflex-00-50", "ecoflex-00-50"),
    ):
        made = combinations({field: [value, "elastosil-m4601"]}, stated)[0].model
        node = made.file.to_document()
        for key in path_of(node, field, ""):
            node = node[int(key)] if isinstance(node, (list, tuple)) else node[key]
        assert node == name


def test_a_material_of_the_library_changes_as_in_the_file(model: Model) -> None:
    """Constants that came from the library do not stay."""
    soft = flexor.load("pneumatic-finger", changes={"silicone.library": "ecoflex-00-50"})
    again = flexor.load(
        flexor.load("pneumatic-finger").file, changes={"silicone.library": "ecoflex-00-50"}
    )
    assert again.hash == soft.hash
    assert again.file.materials["silicone"].winding == "hoop"
    assert not np.array_equal(again.parameters, flexor.load("pneumatic-finger").parameters)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"exosuit.material": ["silicone"]}, "give a list of two or more values"),
        ({"exosuit.material": "silicone"}, "give a list of two or more values"),
        ({"exosuit.material": ["silicone", "silicone"]}, '"silicone" twice'),
        ({"middel": ["with", "without"]}, 'did you mean "middle"'),
        ({"middle": ["with", "no"]}, '"with" and "without" go together'),
        ({"exosuit.material": ["silicone", "silicon"]}, 'silicon: .*did you mean "silicone"'),
        ({"exosuit.section.layr": ["with", "without"]}, 'did you mean "layer"'),
        ({"exosuit.section.floor": ["with", "without"]}, "floor is missing"),
        ({"exosuit.elements": list(range(1, 80))}, "79 combinations: at most 64"),
    ],
)
def test_bad_choices(given: dict[str, Any], message: str, model: Model) -> None:
    with pytest.raises(InputError, match=message):
        combinations(given, model)


def test_a_variable_has_bounds_or_choices(model: Model) -> None:
    document = model.file.to_document()
    both = {"field": "exosuit.length", "bounds": ["8 cm", "9 cm"], "choices": ["8 cm", "9 cm"]}
    for entry, message in (
        (both, r"design.variable\[0\].bounds is given as well as choices"),
        ({"field": "exosuit.length"}, r"design.variable\[0\].bounds is missing"),
    ):
        with pytest.raises(InputError, match=message):
            check({**document, "design": {**document["design"], "variable": [entry]}})
