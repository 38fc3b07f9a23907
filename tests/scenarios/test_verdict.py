"""The verdict of a design: tolerances and fragility, against models loaded one by one."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.model import Model, parse
from flexor.scenarios import Tolerance
from flexor.study import Problem, ScenarioProblem, Study, Uncertainty
from flexor.study.fragility import FRAGILE, fragile
from flexor.study.margins import worst_errors
from flexor.study.sentences import headline


@pytest.fixture(scope="module")
def demo() -> Study:
    """Return the study of the preset's own design problem."""
    model = flexor.load("pneumatic-finger")
    design = model.file.design
    assert design is not None
    return flexor.optimize(
        model,
        design.varied,
        design.aims,
        subject_to=design.subject_to,
        tolerance=design.tolerance,
    )


def test_the_demo_s_optimum_keeps_its_constraints_in_200_neighbours(demo: Study) -> None:
    """Within the tolerances that its file states; some are checked as models of their own."""
    problem = demo.problem
    assert isinstance(problem, ScenarioProblem)
    assert [each.field for each in problem.tolerances] == list(problem.parameters.labels)
    reach = np.array([each.reach for each in problem.tolerances])
    assert (reach[:5] == 5e-4).all()
    random = np.random.default_rng(0).uniform(-1.0, 1.0, (200, 8)) * reach
    found = problem.nominal.evaluate(demo.best.vector + random)
    assert (found.violation == 0.0).all()
    assert demo.best.shown > 1.5 * demo.start.shown
    for error in random[:3]:
        changes = problem.parameters.changes(demo.best.vector + error)  # type: ignore[attr-defined]
        path = flexor.load("pneumatic-finger", changes=changes).equilibrium()
        assert path.stable.all() and path.max_overlap.max() <= 1.5e-3


def test_the_demo_s_verdict_names_the_worst_case(demo: Study) -> None:
    verdict = demo.best.verdict
    assert verdict.feasible and all(each.kept for each in verdict.within)
    (overlap,) = (each for each in verdict.within if each.what == "overlap <= 1.5 mm")
    assert overlap.near and "exosuit.section.wall - 0.5 mm" in overlap.error
    assert "60 kPa" in overlap.place and overlap.value == "1.5 mm"
    assert "exosuit.section.wall + 0.5 mm" in verdict.within[-1].error
    assert verdict.within[-1].what == "range-of-motion"
    assert verdict.steps[0] == "0.5 mm"
    assert verdict.tolerances[3] == "exosuit.section.wall ± 0.5 mm"
    assert (overlap.signs[3], verdict.within[-1].signs[3]) == ("-", "+")
    (use,) = (each for each in verdict.constraints if each.name == "strain-use")
    assert use.place.startswith("fabric of exosuit, X = ")


def test_a_standard_deviation_is_told_in_its_own_unit() -> None:
    assert Tolerance("exosuit.length", "normal", 5e-4, "0.5 mm normal").largest == (
        "1 mm (2 deviations)"
    )
    assert Tolerance("proximal.to.at", "uniform", 0.011, "0.011").largest == "0.011"


def test_an_optimum_without_a_margin_is_not_robust() -> None:
    """The error that breaks it is that of a model of its own."""
    model = flexor.load("pneumatic-finger")
    varied = {"exosuit.section.wall": ("1.5 mm", "3 mm")}
    nominal = Problem.of(model, varied, "maximise bending", subject_to=["overlap <= 1.5 mm"])
    problem = ScenarioProblem.over(
        nominal, Uncertainty(tolerance={"exosuit.section.wall": "0.1 mm"})
    )
    free = flexor.optimize(model, varied, "maximise bending", subject_to=["overlap <= 1.5 mm"])
    found = worst_errors(problem, free.best.vector)
    assert not found.kept
    thin = flexor.load(
        model.file, changes={"exosuit.section.wall": f"{float(free.best.vector[0]) - 1e-4!r} m"}
    )
    assert found.values[-1] == pytest.approx(thin.equilibrium().max_overlap.max(), rel=1e-9)


def test_who_is_not_served_makes_no_design_infeasible() -> None:
    """Errors within the tolerances count as samples: there are no rounds for them."""
    study = flexor.optimize(
        "pneumatic-finger",
        {"exosuit.length": ("9 cm", "10 cm")},
        "maximise range-of-motion",
        subject_to=["overlap <= 1.2 mm"],
        tolerance={"exosuit.section.wall": "0.1 mm"},
        samples=1,
        wearers=2,
        aggregate="served 30 deg",
        budget=4,
    )
    assert not any("round" in each.search for each in study.records)
    found = study.best.verdict
    (overlap,) = (each for each in found.constraints if each.name == "overlap")
    assert overlap.state == "not in all" and overlap.number > 1.2e-3
    assert found.feasible and found.robust
    assert headline(found).startswith("Constraints have to hold for those who are served")


def test_what_is_fragile_is_so_in_models_of_their_own() -> None:
    """Just beyond a snap of the paper's finger, 1 % of some numbers leave out the snap."""
    model = flexor.load("finger", "surface")
    (snap,) = model.equilibrium("0:10:0.5").events
    loads = [0.0, 0.5 * snap.force, 1.003 * snap.force]
    varied = {"exosuit.length": ("8 cm", "12 cm")}
    problem = Problem.of(model, varied, "maximise bending", force=loads)
    value = problem.evaluate(np.array([[0.1]])).shown[0]
    named = {each.name for each in fragile(problem, np.array([0.1]))}
    assert "the load chamber" in named
    of_set = Problem.of(model, "L", "maximise bending", force=loads)
    found = {each.name for each in fragile(of_set, np.array([0.1]))}
    ends = {"exosuit.length", "exosuit.radius.base", "exosuit.radius.tip"}
    assert found - {"L"} == named - ends
    assert ("L" in found) == ("exosuit.length" in named)

    def moved(changed: Model) -> bool:
        shown = np.degrees(changed.equilibrium(loads).joint_angles[-1].sum())
        return not abs(shown - value) <= FRAGILE * value

    fields = {
        "ph_1.length": (0.045, "m"),
        "exosuit.radius.base": (0.0116, "m"),
        "exosuit.young_modulus": (361.1e3, "Pa"),
        "ph_2.length": (0.0253, "m"),
        "ph_1.joint.stiffness": (0.04, "N*m/rad"),
    }
    for name, (size, unit) in fields.items():
        changed = [{name: f"{size * factor!r} {unit}"} for factor in (0.99, 1.01)]
        found = any(moved(flexor.load(model.file, changes=each)) for each in changed)
        assert found == (name in named), name


def test_the_verdict_has_the_warnings_of_the_model() -> None:
    """Those of the design, loaded as a model of its own: without thread the chamber balloons."""
    changes = {"silicone.winding": "none", "evaluation.pressure": "12 kPa"}
    model = flexor.load("pneumatic-finger", changes=changes)
    varied = {"exosuit.section.wall": ("1.5 mm", "3 mm")}
    study = flexor.optimize(model, varied, "minimise mass", budget=3, without=["defaults"])
    own = flexor.load(model.file, changes=study.problem.parameters.changes(study.best.vector))
    assert list(study.best.verdict.warnings) == own.equilibrium().warnings
    assert any("widens" in each for each in study.best.verdict.warnings)
    # That is not the estimate for the wall of the file.
    assert list(study.best.verdict.warnings) != model.equilibrium().warnings


COLUMN = """
name = "column"
planar = true
gravity = { z = "-10 m/s^2" }

[bodies.column]
kind = "rod"
length = "30 cm"
radius = "5 mm"
young_modulus = "5.7 MPa"
poisson_ratio = 0.5
density = "1000 kg/m^3"
placement = { rotation = { y = "-90 deg" } }
strain = { bend_y = "nodal_linear" }
elements = 8
gauss_points = 2

[wrenches.side]
body = "column"
at = "tip"
force = { x = "1 uN" }
input = true

[evaluation]
force = "1 N"
step = "1 N"
"""


def test_numbers_that_are_no_parameters_of_the_engine_are_fragile_too() -> None:
    """A column just below the weight under which it buckles, 7.837 E I / L^3 (Greenhill 1881)."""
    model = Model(parse(COLUMN))
    varied = {"column.young_modulus": ("5.6 MPa", "6 MPa")}
    problem = Problem.of(model, varied, "minimise rod-bending")
    found = {each.name: each.change for each in fragile(problem, np.array([5.7e6]))}
    # Its weight is the product of both.
    assert found["gravity.z"] == pytest.approx(found["column.density"], rel=1e-6)
    assert found["gravity.z"] > 0.2
