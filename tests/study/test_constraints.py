"""Design problems with observables as objectives and constraints."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import flexor
from flexor.constraints import (
    chosen_constraints,
    constraint,
    default_constraints,
    joined_constraints,
    ranks,
)
from flexor.errors import InputError
from flexor.model import Model
from flexor.observables import custom, observable, observables
from flexor.study import Problem, Study

VARIED = {"exosuit.section.wall": ("1.5 mm", "3 mm"), "exosuit.radius.base": ("6 mm", "10 mm")}


@pytest.fixture(scope="module")
def model() -> Model:
    """Return the pneumatic finger."""
    return flexor.load("pneumatic-finger")


def test_observables_are_those_of_the_path(model: Model) -> None:
    """Each agrees with what the path itself reports."""
    paths = model.evaluate(model.own_design)
    path, every = paths[0], observables(model)
    assert np.allclose(every["bending"].values(paths)[0], path.joint_angles.sum(axis=1))
    for name, force in path.strap_forces().items():
        assert np.array_equal(every[f"strap-force.{name}"].values(paths)[0], force)
    assert np.array_equal(every["overlap"].values(paths)[0], path.max_overlap)
    assert np.array_equal(every["strain"].values(paths)[0], path.max_strain)
    limit = model.file.materials["fabric"].strain_limit
    assert limit is not None
    assert every["strain-use"].last(paths)[0] >= abs(path.stretch[-1, 1] - 1.0).max() / limit
    assert every["pressure.chamber"].last(paths)[0] == 60e3
    assert observable("volume", model).name == "volume.chamber"


def test_mass_is_that_of_the_sections(model: Model) -> None:
    """A tube of constant section: its density times its ring times its length."""
    tube = {"section": {"kind": "tube", "wall": "2 mm"}, "radius": "8 mm", "length": "10 cm"}
    changes = {f"exosuit.{key}": value for key, value in tube.items()}
    changes["straps"] = {}
    changed = {**model.file.to_document(), "straps": {}}
    for key, value in tube.items():
        changed["bodies"]["exosuit"][key] = value
    from flexor.model import ModelFile

    other = flexor.load(ModelFile.model_validate(changed))
    paths = other.evaluate(other.own_design, [0.0])
    density = float(model.file.materials["silicone"].density)
    expected = density * np.pi * (0.008**2 - 0.006**2) * 0.1
    assert observable("mass", other).last(paths)[0] == pytest.approx(expected, rel=1e-12)


def test_one_text_is_one_constraint(model: Model) -> None:
    """And one name of a default."""
    listed = chosen_constraints(["overlap <= 1 mm"], ["stretch"], model)
    assert chosen_constraints("overlap <= 1 mm", "stretch", model) == listed


def test_feasible_designs_come_first() -> None:
    """Then others by their violation, then those that failed."""
    value, broken = np.array([-1.0, -9.0, -9.5, np.inf]), np.array([0.0, 0.1, 0.2, np.inf])
    assert np.argsort(ranks(value, broken)).tolist() == [0, 1, 2, 3]
    assert ranks(value, broken)[0] == -1.0


def test_a_users_own_observable_is_known_by_its_name(
    model: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Sought and bounded, as one of the same meaning that Flexor has."""
    monkeypatch.setattr("flexor.observables.catalogue.OWN", own := {})
    monkeypatch.setattr("flexor.observables.own.OWN", own)
    custom("last-joint", lambda path: path.joint_angles[:, 2], unit="deg", text="of the tip")
    x, found = np.array([[2e-3, 9e-3], [2.5e-3, 8e-3]]), []
    for name in ("last-joint", "angle.ph_3"):
        problem = Problem.of(model, VARIED, f"minimise {name}", subject_to=f"{name} <= 20 deg")
        found.append(problem.evaluate(x))
        assert problem.objective.unit == "deg"
    for key in ("value", "shown", "constraint_values", "violation"):
        np.testing.assert_array_equal(*(getattr(paths, key) for paths in found))
    assert observables(model)["last-joint"].text == "of the tip"
    for name, function, unit, message in (
        ("bending", len, "", "Flexor has one of this name"),
        ("Last joint", len, "", "of small letters, digits and single hyphens"),
        ("other", 3, "", "must be a function"),
        ("other", len, "kPam", "write a value with its unit"),
    ):
        with pytest.raises(InputError, match=message):
            custom(name, function, unit=unit)  # type: ignore[arg-type]
    custom("three", lambda path: [1.0, 2.0, 3.0])
    with pytest.raises(InputError, match="or one for each of its 6 loads, but failed"):
        Problem.of(model, VARIED, "minimise three").evaluate(x)


def test_optimum_keeps_its_constraints(model: Model) -> None:
    """The constraint is active, and without it the optimum is better and breaks it."""
    words = ("maximise range-of-motion",)
    bound = flexor.optimize(model, VARIED, *words, subject_to=["overlap <= 1.4 mm"], budget=120)
    free = flexor.optimize(model, VARIED, *words, without=["defaults"], budget=120)
    assert bound.best.feasible
    assert bound.best.constraint_values[-1] <= 1.4e-3
    assert bound.best.path.max_overlap.max() == pytest.approx(bound.best.constraint_values[-1])
    assert free.best.shown > bound.best.shown > bound.start.shown
    assert free.problem.constraints == ()


def test_auto_is_the_default_and_beats_a_single_pattern_search(model: Model) -> None:
    """With the problem of the file: a point on a constraint and three bounds."""
    design = model.file.design
    assert design is not None
    problem = (model, design.varied, design.aims)
    auto = flexor.optimize(*problem, subject_to=design.subject_to, budget=800)
    polls = flexor.optimize(*problem, "pattern-search", subject_to=design.subject_to, budget=800)
    assert auto.settings.values["method"]["name"] == "auto"
    assert auto.best.feasible
    assert auto.best.shown > polls.best.shown + 3.0  # degrees


def test_least_violation_is_best_where_nothing_is_feasible(model: Model) -> None:
    """It is said, and the design nearest to feasibility is the best."""
    study = flexor.optimize(
        model, VARIED, "maximise bending", subject_to=["overlap <= 0.01 mm"], budget=30
    )
    assert not study.best.feasible
    assert study.best.violation == study.record.outcomes().violation.min()
    assert not study.best.verdict.feasible


def test_verdict_names_what_binds(model: Model) -> None:
    """Bounds, the mesh, and the worst error."""
    study = flexor.optimize(model, VARIED, "maximise bending", "pattern-search", budget=80)
    verdict = study.best.verdict
    assert any("exosuit.section.wall at its lower bound, 1.5 mm" in each for each in verdict.bounds)
    assert verdict.finer == pytest.approx(verdict.shown, rel=0.02)
    assert verdict.worst is not None
    assert {each.default for each in verdict.constraints} == {"overlap", "strain", "stretch"}


def test_the_mesh_is_checked_for_parameter_sets_too(model: Model) -> None:
    """A radius that is no field of the file is that of the set at the points of the finer mesh."""
    study = flexor.optimize(model, "RLP", "maximise bending", budget=5)
    verdict, fine = study.best.verdict, flexor.load(model.file, changes={"exosuit.elements": 40})
    design, _ = study.problem.parameters.designs(study.best.vector[None, :], fine)
    bent = np.degrees(fine.equilibrium(design=design).joint_angles[-1].sum())
    assert verdict.finer == pytest.approx(bent, rel=1e-9)
    assert verdict.finer != verdict.shown


def test_optimum_is_that_of_its_model_file(model: Model) -> None:
    """The file with the optimum's values bends as far."""
    study = flexor.optimize(model, VARIED, "maximise bending", budget=40)
    variables = study.problem.parameters
    assert isinstance(variables, flexor.design.Variables)
    changed = flexor.load(model.file, changes=variables.changes(study.best.vector))
    bending = changed.equilibrium().joint_angles[-1].sum()
    assert np.degrees(bending) == pytest.approx(study.best.shown, rel=1e-9)


def test_studies_with_constraints_are_resumed_and_rerun(model: Model, tmp_path: Path) -> None:
    """Constraints and values are recorded, and come back from the folder."""
    words = {"subject_to": ["overlap <= 1.4 mm"], "without": ["stretch"]}
    folder = tmp_path / "study"
    study = flexor.optimize(
        model, VARIED, "maximise range-of-motion", budget=20, folder=folder, **words
    )
    best = study.best
    study.close()
    flexor.study.resume(folder, budget=60).close()
    opened = Study.open(folder)
    assert [each.text(model) for each in opened.problem.constraints] == [
        "strain-use <= 1",
        "overlap <= 1.4 mm",
    ]
    assert opened.evaluations > 20
    assert opened.best.shown >= best.shown
    found = opened.problem.evaluate(opened.record.designs())
    assert found.violation.tobytes() == opened.record.outcomes().violation.tobytes()
    opened.close()
    assert flexor.study.rerun(folder).difference is None


def test_defaults_hold_for_observables_only(model: Model) -> None:
    """The paper's objectives are as the paper states them."""
    assert Problem.of(model, "R01", "bending").constraints == ()
    assert len(Problem.of(model, "R01", "maximise bending").constraints) == 3
    expected = ["overlap", "centreline", "strain", "stretch"]
    assert [each.default for each in default_constraints(model)] == expected


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("overlapp <= 1 mm", 'did you mean "overlap"'),
        ("overlap < 1 mm", "write an observable"),
        ("overlap <= 1", "without a unit"),
        ("overlap <= 1 kPa", "not a length"),
        ("strain <= 5 mm", "plain number"),
        ("obstacle-force <= 1 N", "needs obstacles"),
        ("angle <= 10 deg", "one of several"),
        ("strap-force.midle <= 1 N", 'did you mean "strap-force.middle"'),
    ],
)
def test_bad_constraints(text: str, message: str, model: Model) -> None:
    """Each is one clear sentence."""
    with pytest.raises(InputError, match=message):
        constraint(text, model)


def test_unknown_default_is_an_error(model: Model) -> None:
    """With the nearest name."""
    with pytest.raises(InputError, match='did you mean "overlap"'):
        chosen_constraints([], ["overlaps"], model)


def test_constraints_of_the_command_line_add_to_those_of_the_file(model: Model) -> None:
    """Only one about the same observable, sense and loads replaces one of the file."""
    stated = ("overlap <= 1.5 mm", "bending >= 10 deg at end")
    pressed = "contact-pressure <= 30 kPa"
    assert joined_constraints(stated, [pressed], model) == (*stated, pressed)
    assert joined_constraints(stated, ["overlap <= 1 mm"], model) == (stated[1], "overlap <= 1 mm")
    along = "bending >= 10 deg"
    assert joined_constraints(stated, [along], model) == (*stated, along)
