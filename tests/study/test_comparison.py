"""Comparisons of methods: the same for all, summarised rightly, resumed from any interruption."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from flexor import plot
from flexor.constraints import INFEASIBLE
from flexor.errors import InputError
from flexor.objectives import objective
from flexor.optimizers import (
    CmaEs,
    DifferentialEvolution,
    LevenbergMarquardt,
    PatternSearch,
    SearchResult,
)
from flexor.store import Database
from flexor.study.comparison import (
    ComparisonProgress,
    MethodComparison,
    SearchRun,
    compare,
    data_profiles,
    open_comparison,
    performance_profiles,
    resume_comparison,
)

GIVEN: dict[str, Any] = {
    "parameters": "L,R01",
    "methods": "ps,lm,cma-es,direct",
    "seeds": 3,
    "budget": 60,
}


def content(found: MethodComparison) -> list[tuple[Any, ...]]:
    return [
        (
            run.parameters,
            run.method,
            run.seed,
            run.result.design.tobytes(),
            run.result.improvement_evaluations.tolist(),
            run.result.improvement_values.tobytes(),
            run.result.improvement_designs.tobytes(),
            run.result.reason,
        )
        for run in found.runs
    ]


@pytest.fixture(scope="module")
def whole(analytic: ModuleType) -> MethodComparison:
    """The comparison of GIVEN, one search after the other."""
    return compare(analytic.AnalyticModel(), **GIVEN, workers=1)


def test_every_method_has_the_same_starts_and_its_budget(whole: MethodComparison) -> None:
    found = whole
    assert len(found.runs) == 2 * 4 * 3
    assert found.sets == {"L": 1, "R01": 2}
    assert found.methods == ("pattern-search", "levenberg-marquardt", "cma-es", "direct")
    for name in found.sets:
        for seed in range(3):
            starts = {
                run.result.improvement_designs[0].tobytes()
                for run in found.of(name)
                if run.seed == seed
            }
            assert len(starts) == 1
        assert len({run.result.improvement_designs[0].tobytes() for run in found.of(name)}) == 3
    assert all(run.result.evaluations <= 60 for run in found.runs)
    assert all(run.seconds > 0.0 for run in found.runs)
    # The analytic model's optimum of L is at 11 cm.
    assert found.best("L").result.design[0] == pytest.approx(0.11, abs=1e-5)
    assert found.reference["L"] == found.reference["R01"]


def test_it_does_not_depend_on_how_many_run_at_a_time(
    analytic: ModuleType, whole: MethodComparison
) -> None:
    assert content(compare(analytic.AnalyticModel(), **GIVEN, workers=4)) == content(whole)


class Killed(BaseException):
    pass


def test_killed_anywhere_it_ends_the_same_and_repeats_nothing(
    analytic: ModuleType, whole: MethodComparison, tmp_path: Path
) -> None:
    evaluated, rounds = 0, 0
    while True:
        model = analytic.AnalyticModel()

        def kill(model: Any) -> None:
            if len(model.calls) >= 100:
                raise Killed

        model.before_batch = kill
        try:
            pieces = compare(
                model, **GIVEN, folder=tmp_path / "pieces", resume=rounds > 0, workers=2
            )
            break
        except Killed:
            rounds += 1
            evaluated += sum(model.calls)
            assert rounds < 60
    assert rounds >= 3
    assert content(pieces) == content(whole)
    database = Database(tmp_path / "pieces" / "record.sqlite")
    assert database.one("SELECT count(*) FROM searches") == len(whole.runs)
    assert database.one("SELECT count(*) FROM evaluations") == 0
    database.close()
    # Searches that were interrupted do not claim to know how long they took.
    assert np.isnan([run.seconds for run in pieces.runs]).any()
    last = analytic.AnalyticModel()
    again = compare(last, **GIVEN, folder=tmp_path / "pieces", resume=True)
    assert content(again) == content(whole)
    # The check that there is a vector, and the start of each set, which must be as recorded.
    assert sum(last.calls) == 1 + len(whole.sets)


def test_sets_methods_and_seeds_may_be_added(analytic: ModuleType, tmp_path: Path) -> None:
    model = analytic.AnalyticModel()
    compare(model, "L", methods="ps", seeds=1, budget=20, folder=tmp_path / "c")
    told: list[ComparisonProgress] = []
    more = compare(
        model, "L,R01", methods="ps,de", seeds=[0, 7], budget=20,
        folder=tmp_path / "c", resume=True, progress=told.append,
    )  # fmt: skip
    assert (told[0].done, told[0].total) == (1, 8)
    assert (told[-1].done, told[-1].total) == (8, 8)
    alone = compare(model, "L,R01", methods="ps,de", seeds=[0, 7], budget=20)
    assert content(more) == content(alone)
    settings = json.loads((tmp_path / "c" / "settings.json").read_text())
    assert list(settings["sets"]) == ["L", "R01"]
    assert settings["seeds"] == [0, 7]


def test_methods_with_options_have_labels(analytic: ModuleType, tmp_path: Path) -> None:
    methods = {"1 start": PatternSearch(), "8 starts": PatternSearch(starts=8)}
    found = compare(
        analytic.AnalyticModel(), "R01", methods=methods, seeds=2, budget=50, folder=tmp_path / "c"
    )
    assert found.methods == ("1 start", "8 starts")
    assert found.of("R01", "8 starts")[0].result.improvement_evaluations.tolist() != []
    with pytest.raises(InputError, match=r'start\.name = "pattern-search", not "cma-es"'):
        compare(
            analytic.AnalyticModel(), "R01", methods={"1 start": CmaEs()}, seeds=2, budget=50,
            folder=tmp_path / "c", resume=True,
        )  # fmt: skip


def run(
    parameters: str, method: str, seed: int, values: list[float], at: list[int], spent: int
) -> SearchRun:
    """A search that began at 10 and improved to values after so many evaluations."""
    designs = np.arange(len(values), dtype=float)[:, None]
    result = SearchResult(
        design=designs[-1] if len(values) else np.zeros(1),
        value=values[-1] if values else np.inf,
        evaluations=spent,
        iterations=1,
        reason="done",
        improvement_evaluations=np.array(at, dtype=np.int64),
        improvement_values=np.array(values, dtype=float),
        improvement_designs=designs,
    )
    return SearchRun(parameters, method, seed, result, 1.0 + seed)


@pytest.fixture
def made() -> MethodComparison:
    """Two methods on two sets with two seeds, whose numbers can be checked by hand."""
    runs = (
        run("A", "one", 0, [9.0, 1.05, 0.0], [1, 10, 40], 50),
        run("A", "one", 1, [9.0, 5.0], [1, 20], 50),
        run("A", "two", 0, [9.0, 0.09], [1, 20], 30),
        run("A", "two", 1, [9.0, 0.05], [1, 30], 30),
        run("B", "one", 0, [3.0, 2.0], [1, 6], 10),
        run("B", "one", 1, [], [], 10),
        run("B", "two", 0, [3.0], [1], 10),
        run("B", "two", 1, [2.5], [1], 10),
    )
    return MethodComparison(
        model="m",
        objective=objective("f_b"),
        budget=50,
        sets={"A": 1, "B": 3},
        methods=("one", "two"),
        seeds=(0, 1),
        reference={"A": 10.0, "B": np.inf},
        runs=runs,
    )


def test_targets_are_parts_of_the_best_gain(made: MethodComparison) -> None:
    assert made.best_known("A") == 0.0
    assert made.target("A") == pytest.approx(0.1)
    assert made.target("A", 0.2) == pytest.approx(2.0)
    # The start of B fails: gains count from the worst value that a search began from.
    assert made.target("B") == pytest.approx(3.0 - 0.99 * (3.0 - 2.0))
    assert replace(made, known={"A": -10.0}).target("A") == pytest.approx(-9.8)
    # A start that is as good as anything: only the best counts, and no more than it.
    assert replace(made, reference={"A": 0.0, "B": 1.0}).target("A") == 0.0
    assert replace(made, reference={"A": 0.0, "B": 1.0}).target("B") == 2.0


def test_summaries_are_what_one_counts_by_hand(made: MethodComparison) -> None:
    one, two = made.summary("A", "one"), made.summary("A", "two")
    assert (one.best, one.median, one.worst) == (0.0, 2.5, 5.0)
    assert (one.success, one.evaluations) == (0.5, 40.0)
    assert one.expected_evaluations == 40 + 50
    assert (two.success, two.evaluations, two.expected_evaluations) == (1.0, 25.0, 25.0)
    assert (one.spent, one.seconds, one.searches) == (50.0, 1.5, 2)
    failed = made.summary("B", "one")
    assert (failed.best, failed.median, failed.worst) == (2.0, np.inf, np.inf)
    lost = made.summary("B", "two")
    assert (lost.success, lost.evaluations, lost.expected_evaluations) == (0.0, np.inf, np.inf)
    table = made.table()
    assert table["to_target"].tolist() == [40, np.inf, 20, 30, 6, np.inf, np.inf, np.inf]
    assert table["start"].tolist() == [9, 9, 9, 9, 3, np.inf, 3, 2.5]
    run = made.runs[0]
    worse = replace(run.result, improvement_values=np.array([1.5 * INFEASIBLE, 1.0]), value=1.0)
    table = replace(made, runs=(replace(run, result=worse), *made.runs[1:])).table()
    assert np.isnan(table["start"][0]) and table["start_excess"][0] == pytest.approx(0.5)
    assert (table["value"][0], table["excess"][0]) == (1.0, 0.0)
    with pytest.raises(InputError, match='unknown method of the comparison "tow"'):
        made.summary("A", "tow")


def test_profiles_are_what_one_counts_by_hand(made: MethodComparison) -> None:
    # Costs: one 40, -, 6, -; two 20, 30, -, -; the fastest 20, 30, 6, none.
    one, two = performance_profiles(made)
    assert (one.cost.tolist(), one.solved.tolist()) == ([1.0, 2.0], [0.25, 0.5])
    assert (two.cost.tolist(), two.solved.tolist()) == ([1.0, 1.0], [0.25, 0.5])
    assert (one.at(1.0), one.at(1.9), one.at(2.0), two.at(1.0)) == (0.25, 0.25, 0.5, 0.5)
    one, two = data_profiles(made)
    assert one.cost.tolist() == [6 / 4, 40 / 2]
    assert two.cost.tolist() == [20 / 2, 30 / 2]
    assert (one.at(1.0), one.at(1.5), two.at(12.0)) == (0.0, 0.25, 0.25)


def test_the_figure_names_its_methods_and_problems(
    made: MethodComparison, whole: MethodComparison, tmp_path: Path
) -> None:
    figure = plot.profiles(made)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["one", "two"]
    left, right = figure.axes
    assert "(2 sets × 2 seeds)" in left.get_ylabel()
    assert (left.get_xlim()[0], right.get_xlim()[0]) == (1.0, 0.0)
    plot.save(figure, tmp_path / "profiles.svg")
    titles = [text.get_text() for text in plot.profiles(whole).legends[0].get_texts()]
    assert titles == ["pattern search", "Levenberg-Marquardt", "CMA-ES", "DIRECT"]


def test_a_start_that_fails_is_drawn_again(analytic: ModuleType) -> None:
    # Designs with R_1 < 0.45 cm fail: with these bounds two of three.
    from flexor.design import parameter_set

    chosen = parameter_set("R01").with_bounds({"R_1": (0.0042, 0.00465)}).with_start([0.01, 0.0046])
    found = compare(analytic.AnalyticModel(), [chosen], methods="lm", seeds=6, budget=5)
    assert all(len(each.result.improvement_values) for each in found.runs)
    assert all(each.result.improvement_evaluations[0] == 1 for each in found.runs)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"parameters": "L,R10"}, 'unknown parameter set "R10" (did you mean "R01"?)'),
        ({"parameters": ""}, "give at least one parameter set"),
        ({"parameters": "L,L"}, 'the parameter set "L" is given twice'),
        ({"methods": "cma-se"}, 'did you mean "cma-es"?'),
        ({"methods": "ps,pattern-search"}, 'the method "pattern-search" is given twice'),
        ({"methods": []}, "give at least one method"),
        ({"methods": {}}, "give at least one method"),
        ({"objective": "f_exo", "methods": "lm"}, "is not the norm of a vector"),
        ({"seeds": 0}, "seeds is 0: it must be at least 1"),
        ({"seeds": [1, 1]}, "distinct non-negative integers"),
        ({"seeds": [1, -1]}, "a seed is -1: it must be at least 0."),
        ({"seeds": "3"}, 'seeds is "3": it must be an integer of at least 1.'),
        ({"seeds": 2.0}, "seeds is 2.0: it must be an integer of at least 1."),
        ({"budget": 0}, "budget is 0: it must be at least 1"),
        ({"budget": 2.5}, "budget is 2.5: it must be an integer of at least 1."),
        ({"workers": -1}, "workers is -1: it must be at least 0."),
        ({"progress": 3}, "progress is 3: it must be a function."),
        ({"resume": True}, "resuming a comparison needs its folder"),
    ],
)
def test_bad_input_is_one_sentence(
    analytic: ModuleType, arguments: dict[str, Any], said: str
) -> None:
    with pytest.raises(InputError) as refusal:
        compare(analytic.AnalyticModel(), **{**GIVEN, **arguments})
    assert said in str(refusal.value)
    assert str(refusal.value).endswith(".")


def test_folders_that_cannot_be_used(analytic: ModuleType, tmp_path: Path) -> None:
    model, given = analytic.AnalyticModel(), {**GIVEN, "methods": "ps", "parameters": "L"}
    compare(model, **given, folder=tmp_path / "c")
    cases: list[tuple[dict[str, Any], str]] = [
        ({"folder": tmp_path / "c"}, "holds recorded work already"),
        ({"folder": tmp_path / "d", "resume": True}, "is not a comparison: there is no such"),
        ({"folder": tmp_path, "resume": True}, "is not a comparison: it has no settings.json"),
        ({"folder": tmp_path}, "is not an empty folder"),
        ({"folder": tmp_path / "c", "resume": True, "budget": 61}, "made with budget = 60, not 61"),
        ({"folder": tmp_path / "c", "resume": True, "objective": "f_bc"}, "made with objective"),
    ]
    for more, said in cases:
        with pytest.raises(InputError, match=said):
            compare(model, **{**given, **more})


@pytest.mark.parametrize(
    "result", ["{", "[" * 100_000, '{"design": [1]}', "HUGE", "NaN", '{"design": {}}']
)
def test_a_damaged_search_is_one_sentence(
    analytic: ModuleType, tmp_path: Path, result: str
) -> None:
    model, given = analytic.AnalyticModel(), {**GIVEN, "methods": "ps", "parameters": "L"}
    compare(model, **given, folder=tmp_path / "c")
    database = Database(tmp_path / "c" / "record.sqlite")
    kept = str(database.one("SELECT result FROM searches"))
    if result == "HUGE":
        result = json.dumps({**json.loads(kept), "seconds": 10**400})
    database.write(("UPDATE searches SET result = ?", [(result,)]))
    database.close()
    with pytest.raises(InputError, match=r'record\.sqlite" cannot be used: a finished search is'):
        compare(model, **given, folder=tmp_path / "c", resume=True)


@pytest.mark.parametrize(
    "values",
    [
        [],
        {"format": 3},
        {"seeds": [10**400, "a"]},
        {"budget": "many"},
        {"sets": {"L": {"labels": ["L"], "lower": [], "upper": [1.0]}}},
        {"methods": 10**5000},
    ],
)
def test_damaged_settings_are_one_sentence(
    analytic: ModuleType, tmp_path: Path, values: Any
) -> None:
    given = {**GIVEN, "methods": "ps", "parameters": "L", "seeds": 1, "folder": tmp_path / "c"}
    compare(analytic.AnalyticModel(), **given)
    path = tmp_path / "c" / "settings.json"
    if isinstance(values, dict) and "format" not in values:
        values = {**json.loads(path.read_text()), **values}
    limit = sys.get_int_max_str_digits()
    sys.set_int_max_str_digits(0)
    path.write_text(json.dumps(values))
    sys.set_int_max_str_digits(limit)
    with pytest.raises(InputError, match=r"is damaged: it is not the settings of a comparison\.$"):
        compare(analytic.AnalyticModel(), **given, resume=True)


def test_a_finished_comparison_is_read(analytic: ModuleType, tmp_path: Path) -> None:
    model, given = analytic.AnalyticModel(), {**GIVEN, "methods": "ps", "parameters": "L"}
    whole = compare(model, **given, folder=tmp_path / "c")
    found = open_comparison(tmp_path / "c")
    assert content(found) == content(whole)
    for name in ("model", "budget", "sets", "methods", "seeds", "reference"):
        assert getattr(found, name) == getattr(whole, name)
    database = Database(tmp_path / "c" / "record.sqlite")
    database.write(("DELETE FROM searches WHERE search LIKE ?", [("%0]",)]))
    database.close()
    with pytest.raises(InputError, match="lacks 1 of 3 searches: resume it"):
        open_comparison(tmp_path / "c")


def test_a_comparison_that_no_longer_reproduces_is_refused(
    analytic: ModuleType, tmp_path: Path
) -> None:
    model, given = analytic.AnalyticModel(), {**GIVEN, "methods": "ps", "parameters": "L"}
    compare(model, **given, folder=tmp_path / "c")
    database = Database(tmp_path / "c" / "record.sqlite")
    database.note("reference", {"L": 123.0})
    database.close()
    with pytest.raises(InputError, match="no longer reproduces: it recorded 123, which is now "):
        compare(model, **{**given, "seeds": 4}, folder=tmp_path / "c", resume=True)


def test_a_folder_of_the_first_format_is_refused(tmp_path: Path) -> None:
    (tmp_path / "comparison.json").write_text('{"format": 1}')
    with pytest.raises(InputError, match=r"has format 1; this version of Flexor reads format 3"):
        resume_comparison(tmp_path)


def test_methods_of_a_users_own(analytic: ModuleType) -> None:
    found = compare(
        analytic.AnalyticModel(),
        "L",
        methods={"a": LevenbergMarquardt(starts=2), "b": DifferentialEvolution(population=6)},
        seeds=1,
        budget=30,
    )
    assert {run.method for run in found.runs} == {"a", "b"}


VARIED = {"exosuit.section.wall": ("1.5 mm", "3 mm"), "exosuit.radius.base": ("6 mm", "10 mm")}


def test_methods_are_compared_with_constraints(tmp_path: Path) -> None:
    """On fields of the file; resumed and opened they are the same."""
    import flexor

    model = flexor.load("pneumatic-finger")
    found = flexor.compare(
        model,
        VARIED,
        "maximise range-of-motion",
        subject_to=["overlap <= 1.3 mm"],
        methods="auto,pattern-search,multistart-bfgs",
        seeds=2,
        budget=30,
        folder=tmp_path / "c",
    )
    assert list(found.sets) == ["fields"]
    best = found.best("fields").result
    problem = flexor.study.Problem.of(
        model, VARIED, "maximise range-of-motion", subject_to=["overlap <= 1.3 mm"]
    )
    paths = problem.evaluate(best.design[None, :])
    assert paths.violation[0] == 0.0
    assert paths.value[0] == best.value
    own = problem.evaluate(problem.parameters.start[None, :])
    assert found.reference["fields"] == problem.ranks(own)[0]
    again = resume_comparison(tmp_path / "c")
    opened = open_comparison(tmp_path / "c")
    for other in (again, opened):
        assert other.best("fields").result.value == best.value
        assert other.objective.name == found.objective.name


def test_gain_over_an_infeasible_start_is_over_feasible_designs() -> None:
    """The target is between the first feasible values and the best, not a violation."""
    values = [np.array([1.5e9, 2.0, 1.0]), np.array([1.2e9, 3.0, 1.1]), np.array([1.4e9])]
    runs = tuple(
        SearchRun(
            "s",
            "m",
            seed,
            SearchResult(
                design=np.zeros(1),
                value=float(found[-1]),
                evaluations=9,
                iterations=1,
                reason="",
                improvement_evaluations=np.arange(1, len(found) + 1),
                improvement_values=found,
                improvement_designs=np.zeros((len(found), 1)),
            ),
            0.0,
        )
        for seed, found in enumerate(values)
    )
    made = MethodComparison(
        model="m",
        objective=objective("bending"),
        budget=9,
        sets={"s": 1},
        methods=("m",),
        seeds=(0, 1, 2),
        reference={"s": 1.3e9},
        runs=runs,
    )
    assert made.target("s") == pytest.approx(1.0 + 0.01 * (3.0 - 1.0))
    summary = made.summary("s", "m")
    assert summary.success == pytest.approx(1.0 / 3.0)
    assert summary.median == 1.1
