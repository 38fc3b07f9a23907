"""Wearers drawn from a population."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.model import Model
from flexor.model.reading import check
from flexor.scenarios import scenarios, wearer, wearers
from flexor.scenarios.population import SURVEYS
from flexor.study import Problem, ScenarioProblem, Study, Uncertainty

VARIED = {"exosuit.length": ("9 cm", "11 cm"), "exosuit.section.wall": ("1.5 mm", "3 mm")}
MEN = SURVEYS["ansur2-men"]


@pytest.fixture(scope="module")
def model() -> Model:
    """Return the pneumatic finger, coarse."""
    document = flexor.load("pneumatic-finger").file.to_document()
    document["bodies"]["exosuit"]["elements"] = 8
    for name, place in (("proximal", 0.25), ("middle", 0.625), ("distal", 0.875)):
        document["straps"][name]["at"] = place
    return flexor.load(check(document))


def test_hands_and_joints_follow_their_distributions(model: Model) -> None:
    drawn = wearers(model, 512, 3)
    value = {
        key: np.array([float(str(found[key]).split()[0]) for found in map(_fields, drawn)])
        for key in ("ph_2.length", "ph_2.base", "ph_3.stiffness")
    }
    length = value["ph_2.length"] / 0.0253 * MEN.length
    breadth = value["ph_2.base"] / 0.0139 * MEN.breadth
    assert length.mean() == pytest.approx(MEN.length, rel=1e-3)
    assert length.std() == pytest.approx(MEN.length_deviation, rel=0.02)
    # The 5th and 95th percentiles of the survey itself are 177 and 210 mm, 81 and 96 mm.
    assert np.quantile(length, [0.05, 0.95]) == pytest.approx([0.177, 0.210], abs=1.5e-3)
    assert np.quantile(breadth, [0.05, 0.95]) == pytest.approx([0.081, 0.096], abs=1.5e-3)
    assert np.corrcoef(length, breadth)[0, 1] == pytest.approx(MEN.correlation, abs=0.03)
    multiple = value["ph_3.stiffness"] / 0.02
    assert (multiple.min() >= 0.8, multiple.max() <= 16.0) == (True, True)
    assert np.median(multiple) == pytest.approx(np.sqrt(0.8 * 16.0), rel=0.02)
    assert [each.name for each in wearers(model, 8, 3)] == [each.name for each in drawn[:8]]


def _fields(scenario: flexor.scenarios.Scenario) -> dict[str, object]:
    bodies = scenario.changes["bodies"]
    return {
        "ph_2.length": bodies["ph_2"]["length"],
        "ph_2.base": bodies["ph_2"]["radius"]["base"],
        "ph_3.stiffness": bodies["ph_3"]["joint"]["stiffness"],
    }


def test_a_design_for_a_wearer_is_that_of_a_file_with_the_wearer_s_finger(model: Model) -> None:
    """Straps keep their slack on every finger."""
    small = wearer(model, 0.172, 0.078, 2.0, name="small")
    assert small.name == "small (hand 172 x 78 mm, stiffness x 2)"
    nominal = Problem.of(model, VARIED, "maximise bending")
    problem = ScenarioProblem.over(nominal, Uncertainty(scenarios=[small], wearers=2))
    design = np.array([0.105, 0.0025])
    alone = flexor.load(
        small.model(model).file,
        changes={"exosuit.length": "10.5 cm", "exosuit.section.wall": "2.5 mm"},
    )
    expected = np.degrees(alone.equilibrium().joint_angles[-1].sum())
    none = np.zeros((1, 0))
    found = [each.shown[0] for each in problem.by_case(design[None], none)]
    assert found[0] == pytest.approx(expected, rel=1e-9)
    assert problem.evaluate(design[None]).shown[0] == pytest.approx(np.mean(found), rel=1e-12)


def test_a_wearer_by_percentile_is_one_of_its_measures(model: Model) -> None:
    """Of normal hands; 95 % is 1.645 standard deviations above the mean."""
    small, large = scenarios("5%,95%=2", model)
    hands = SURVEYS["ansur2-men"]
    length, breadth = (
        mean + 1.6448536 * deviation
        for mean, deviation in (
            (hands.length, hands.length_deviation),
            (hands.breadth, hands.breadth_deviation),
        )
    )
    expected = wearer(model, length, breadth, name="wearer of 95%")
    assert (small.weight, large.weight) == (1.0, 2.0)
    assert large.name == expected.name == "wearer of 95% (hand 210 x 96 mm, stiffness x 1)"
    own, there = large.model(model).parameters, expected.model(model).parameters
    np.testing.assert_allclose(own, there, rtol=1e-8)
    ratio = small.model(model).file.bodies["ph_1"].length / model.file.bodies["ph_1"].length
    assert ratio == pytest.approx((2.0 * hands.length - length) / hands.length, rel=1e-8)
    for text in ("0%", "100%", "many%"):
        with pytest.raises(InputError, match='a percentile between 0 and 100, such as "95%"'):
            scenarios(text, model)


def test_a_search_over_many_wearers_begins_with_the_model_as_it_is(
    model: Model, tmp_path: Path
) -> None:
    words = {"wearers": 10, "aggregate": "served 35 deg", "budget": 60}
    study = flexor.optimize(
        model,
        VARIED,
        "maximise bending",
        folder=tmp_path / "s",
        method_options={"tolerance": 0.05},
        **words,
    )
    first, second = study.records
    assert min(len(first), len(second)) > 10 and study.evaluations == len(first) + len(second)
    assert 0.0 < study.best.shown <= 100.0 and study.best.shown % 10.0 == pytest.approx(0.0)
    best = study.best.vector.tobytes()
    study.close()
    opened = Study.open(tmp_path / "s")
    assert opened.best.vector.tobytes() == best
    opened.close()
    assert flexor.study.rerun(tmp_path / "s").same


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"length": ["ph_1.lenght"]}, 'did you mean "length"'),
        ({"hands": "ansur2-women"}, 'unknown survey of hands "ansur2-women"'),
        ({"stiffness": ["exosuit.kind"]}, "which is not a number"),
        ({"length": ["ph_1.length"], "breadth": ["bodies.ph_1.length"]}, "is named twice"),
    ],
)
def test_bad_populations(model: Model, table: dict[str, object], message: str) -> None:
    changed = check({**model.file.to_document(), "population": table})
    with pytest.raises(InputError, match=message):
        wearers(flexor.load(changed), 2)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"stiffness_range": [2.0, 1.0]}, "the first multiple must not be above the second"),
        ({"stiffness_range": 2.0}, r"write two multiples, such as \[0.8, 16.0\]"),
        ({"hand_length": 0.19}, "a number without a unit"),
        ({"lengths": []}, 'did you mean "length"'),
    ],
)
def test_bad_tables(model: Model, table: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        check({**model.file.to_document(), "population": table})


def test_a_file_without_a_population_has_no_wearers() -> None:
    with pytest.raises(InputError, match=r"has no \[population\]"):
        wearers(flexor.load("finger"), 2)


def test_fields_of_parts_by_a_pattern() -> None:
    glove = flexor.load("glove")
    table = {"length": ["*.ph_1.length", "{index,middle}.ph_2.length"]}
    model = flexor.load(check({**glove.file.to_document(), "population": table}))
    changed = wearer(model, 1.1 * MEN.length, MEN.breadth).changes["bodies"]
    fingers = [name for name in glove.file.bodies if name.endswith(".ph_1")]
    assert len(fingers) == 5
    assert set(changed) == {*fingers, "index.ph_2", "middle.ph_2"}
    length = float(str(changed["index.ph_1"]["length"]).split()[0])
    assert length == pytest.approx(1.1 * float(glove.file.bodies["index.ph_1"].length))
