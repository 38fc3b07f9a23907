"""Design problems over scenarios and tolerances."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.model import Model, parse
from flexor.model.reading import check
from flexor.optimizers import Auto
from flexor.scenarios import Scenario
from flexor.study import Problem, ScenarioProblem, Study, Uncertainty

VARIED = {"exosuit.section.wall": ("1.5 mm", "3 mm"), "exosuit.radius.base": ("6 mm", "10 mm")}
TOLERANCE = {"exosuit.section.wall": "0.1 mm", "exosuit.radius.base": "0.3 mm"}
AIM = "maximise bending"
DESIGNS = np.array([[0.002, 0.008], [0.0025, 0.009], [0.0018, 0.0085]])


@pytest.fixture(scope="module")
def model() -> Model:
    """Return the pneumatic finger, coarse, with other fingers as variants."""
    document = flexor.load("pneumatic-finger").file.to_document()
    document["bodies"]["exosuit"]["elements"] = 8
    for name, place in (("proximal", 0.25), ("middle", 0.625), ("distal", 0.875)):
        document["straps"][name]["at"] = place
    document["variants"] = {
        "long": {"weight": 3.0, "bodies": {"ph_1": {"length": "4.8 cm"}}},
        "stiff": {"bodies": {"ph_1": {"joint": {"stiffness": "0.08 N*m/rad"}}}},
    }
    return flexor.load(check(document))


def problem(model: Model, aim: str = AIM, **stated: object) -> ScenarioProblem:
    """Return the problem over scenarios."""
    nominal = Problem.of(model, VARIED, aim, subject_to=["overlap <= 0.8 mm"])
    return ScenarioProblem.over(nominal, Uncertainty(**stated))  # type: ignore[arg-type]


def test_scenarios_are_those_of_the_variants_loaded_alone(model: Model) -> None:
    """The mean is weighted, and the worst scenario's violation counts."""
    found = problem(model, scenarios="all").evaluate(DESIGNS)
    alone = []
    for name in ("long", "stiff"):
        other = flexor.load(model.file, name)
        alone.append(
            Problem.of(other, VARIED, AIM, subject_to=["overlap <= 0.8 mm"]).evaluate(DESIGNS)
        )
    mean = 0.75 * alone[0].value + 0.25 * alone[1].value
    np.testing.assert_allclose(found.value, mean, rtol=1e-9)
    worst = np.maximum(alone[0].violation, alone[1].violation)
    np.testing.assert_allclose(found.violation, worst, rtol=1e-6)
    assert worst.max() > 0.0
    # What is recorded of the path is that of the model as it is.
    nominal = Problem.of(model, VARIED, AIM).evaluate(DESIGNS)
    np.testing.assert_allclose(found.joint_angles, nominal.joint_angles, rtol=1e-9, atol=1e-12)
    again = problem(model, scenarios="all").evaluate(DESIGNS, threads=1)
    assert again.value.tobytes() == found.value.tobytes()
    one = problem(model, scenarios="all").evaluate(DESIGNS[1:2])
    assert one.value[0] == found.value[1]


@pytest.mark.parametrize("aggregate", ["mean", "worst", "quantile 0.5"])
def test_gradients_of_aggregates_are_those_of_differences(model: Model, aggregate: str) -> None:
    made = problem(
        model,
        scenarios={"long": 1.0, "stiff": 2.0},
        aggregate=aggregate,
        tolerance={**TOLERANCE, "ph_2.joint.stiffness": "0.005 N*m/rad"},
        samples=2,
    )
    exact = made.gradients(made.evaluate(DESIGNS[:1], gradient=True))[0]
    step = np.array([1e-7, 1e-7])
    for i in range(2):
        shift = np.zeros(2)
        shift[i] = step[i]
        values = made.evaluate(np.stack([DESIGNS[0] + shift, DESIGNS[0] - shift])).value
        assert exact[i] == pytest.approx((values[0] - values[1]) / (2.0 * step[i]), rel=1e-5)


@pytest.mark.parametrize("words", [{"scenarios": {"long": 1.0}}, {"tolerance": TOLERANCE}])
def test_aggregates_need_no_constraints(model: Model, words: dict[str, Any]) -> None:
    study = flexor.optimize(model, VARIED, AIM, without=["defaults"], budget=12, **words)
    assert study.problem.constraints == ()
    assert study.best.feasible and study.best.shown >= study.start.shown


def test_an_error_of_another_field_is_that_of_the_file(model: Model) -> None:
    made = problem(model, tolerance={"ph_1.joint.stiffness": "0.01 N*m/rad"})
    (shifted,) = made.by_case(DESIGNS, np.array([[0.01]]))
    changed = flexor.load(model.file, changes={"ph_1.joint.stiffness": "0.05 N*m/rad"})
    expected = Problem.of(changed, VARIED, AIM).evaluate(DESIGNS)
    np.testing.assert_allclose(shifted.value, expected.value, rtol=1e-9)


def test_the_optimum_keeps_its_constraints_for_every_error(model: Model, tmp_path: Path) -> None:
    """One without a margin does not; and studies of several rounds are resumed and repeated."""
    words = {"subject_to": ["overlap <= 1.4 mm"]}
    free = flexor.optimize(model, VARIED, AIM, budget=150, **words)
    folder = tmp_path / "study"
    robust = flexor.optimize(
        model, VARIED, AIM, budget=400, tolerance=TOLERANCE, folder=folder, **words
    )
    random = np.random.default_rng(3).uniform(-1.0, 1.0, (200, 2)) * [1e-4, 3e-4]
    assert (free.problem.evaluate(free.best.vector + random).violation > 0.0).any()
    assert (free.problem.evaluate(robust.best.vector + random).violation == 0.0).all()
    assert robust.start.shown < robust.best.shown < free.best.shown
    assert len(robust.records) > 1
    best, evaluations = robust.best.vector.tobytes(), robust.evaluations
    robust.close()
    for again in (Study.open(folder), flexor.study.resume(folder)):
        assert again.best.vector.tobytes() == best
        assert again.evaluations == evaluations
        again.close()
    assert flexor.study.rerun(folder).same


def test_few_designs_are_enough_where_each_is_many_paths(
    model: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As good as what a pattern search with small steps finds, with fewer designs."""
    words = {"subject_to": ["overlap <= 1.4 mm"], "tolerance": TOLERANCE, "samples": 4}
    few = flexor.optimize(model, VARIED, AIM, **words)
    one = flexor.optimize(model, VARIED, AIM, executor=flexor.study.Threads(1), **words)
    for each, other in zip(few.records, one.records, strict=True):
        assert each.designs().tobytes() == other.designs().tobytes()
        assert each.outcomes().value.tobytes() == other.outcomes().value.tobytes()
    assert few.best.vector.tobytes() == one.best.vector.tobytes()
    assert few.robust
    monkeypatch.setattr(Auto, "_refine_coarsely", Auto._refine_finely)
    many = flexor.optimize(model, VARIED, AIM, **words)
    assert many.robust
    assert few.best.shown > many.best.shown * (1.0 - 1e-4)
    assert few.evaluations < many.evaluations


def test_a_budget_leaves_a_share_for_the_robust_design(model: Model, tmp_path: Path) -> None:
    """The search without errors takes half of it; resumed with more, the other one goes on."""
    tolerance = {"exosuit.section.wall": "0.5 mm"}
    words = {"subject_to": ["overlap <= 0.9 mm"], "tolerance": tolerance}
    few = flexor.optimize(model, VARIED, AIM, budget=8, folder=tmp_path / "s", **words)
    assert [len(each) for each in few.records] == [4, 4]
    assert few.finished == "the budget of 8 evaluations is spent before a robust design was found"
    few.close()
    more = flexor.study.resume(tmp_path / "s", budget=14)
    assert [len(each) for each in more.records] == [4, 10]
    more.close()
    assert flexor.study.rerun(tmp_path / "s").same


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ({"scenarios": ["lnog"]}, 'unknown variant "lnog" (did you mean "long"?)'),
        ({"scenarios": "long=0"}, 'scenario "long" has the weight 0.0: it must be a number above'),
        ({"scenarios": "long=much"}, "has the weight much"),
        ({"scenarios": "long,long"}, 'scenario "long" is given twice'),
        ({"tolerance": {"exosuit.section.wall": "0.1"}}, "write a value with its unit"),
        ({"tolerance": {"exosuit.section.wall": 0.1}}, "expected a value with its unit"),
        ({"tolerance": {"exosuit.section.wal": "1 mm"}}, 'did you mean "wall"'),
        ({"tolerance": {"ph_1.joint.stiffness": "1 mm"}}, "such as N*m/rad"),
        ({"tolerance": {"exosuit.section.wall": "0 mm"}}, "must be above 0"),
        ({"tolerance": {"exosuit.section.wall": "1 mm uniformly"}}, 'did you mean "uniform"'),
        (
            {"tolerance": {"ph_1.length": "1 m"}},
            'tolerance of "ph_1.length", 1 m, is not below its value, 4.5 cm: it has to be smaller',
        ),
        (
            {"tolerance": {"exosuit.section.wall": "1 mm normal"}},
            '"exosuit.section.wall", 2 mm (2 deviations), is not below its lower bound, 1.5 mm',
        ),
        (
            {"tolerance": {"exosuit.section.wall": "1 mm", "bodies.exosuit.section.wall": "1 mm"}},
            "is the same field as",
        ),
        ({"samples": 4, "scenarios": "long"}, "samples of errors need a tolerance"),
        (
            {"tolerance": TOLERANCE, "scenarios": "all", "aggregate": "served 10 deg"},
            'aggregate "served 10 deg" counts errors within the tolerances as samples',
        ),
        (
            {"scenarios": [Scenario("flat", 1.0, {"bodies": {"ph_1": {"length": "0 cm"}}})]},
            'scenario "flat": bodies.ph_1.length is "0 cm": it must be greater than zero',
        ),
        (
            {"scenarios": [Scenario("thick", 1.0, {"bodies": {"exosuit": {"radius": "1 cm"}}})]},
            'scenario "thick": it changes "exosuit.radius.base", which is a design variable',
        ),
    ],
)  # fmt: skip
def test_bad_statements(model: Model, stated: dict[str, object], message: str) -> None:
    with pytest.raises(InputError) as caught:
        problem(model, **stated)
    assert message in str(caught.value)


def test_the_paper_s_objectives_have_no_scenarios(model: Model) -> None:
    with pytest.raises(InputError, match="maximise or minimise an observable"):
        flexor.optimize(model, "R01", "f_b", scenarios="all")


THICK = """
name = "suit"
planar = true
[materials]
silicone = { library = "dragon-skin-30", winding = "hoop" }
[bodies.suit]
kind = "rod"
length = "10 cm"
radius = { base = "8 mm", tip = "8 mm" }
material = "silicone"
section = { kind = "half-round", wall = "2 mm", floor = "2 mm" }
strain = { bend_y = "nodal_linear", extend_x = "nodal_linear" }
elements = 4
gauss_points = 2
[actuators.chamber]
kind = "pressure"
rod = "suit"
[evaluation]
pressure = "10 kPa"
pressure_step = "5 kPa"
[variants.thin]
bodies.suit.section.floor = "1.8 mm"
[variants.thick]
bodies.suit.section.floor = "13 mm"
"""


def test_a_scenario_that_breaks_some_designs() -> None:
    """Where the floor of a narrow suit has no room it fails, and never becomes a number."""
    model = Model(parse(THICK))
    varied = {"suit.radius.tip": ("6.5 mm", "9 mm")}
    designs = np.array([[6.6e-3], [7e-3], [8e-3], [8.9e-3]])
    shown = {}
    for aggregate in ("mean", "worst", "served -30 deg"):
        stated = Uncertainty(("thin", "thick"), aggregate)
        nominal = Problem.of(model, varied, "maximise rod-bending", without=["defaults"])
        found = ScenarioProblem.over(nominal, stated).evaluate(designs)
        shown[aggregate] = found.shown
        if not aggregate.startswith("served"):
            assert (np.isfinite(found.value) == [False, False, True, True]).all()
            assert all('in scenario "thick"' in reason for reason in found.reason[:2])
            assert (found.reason[2:] == "").all()
            assert (np.isnan(found.shown) == np.isinf(found.value)).all()
    assert (shown["worst"][2:] < shown["mean"][2:]).all()
    assert shown["served -30 deg"].tolist() == [50.0, 50.0, 100.0, 100.0]
