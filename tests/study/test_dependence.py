"""What no variable has an effect on, or no design seems to keep, is said before a search."""

from __future__ import annotations

import warnings

import pytest

import flexor
from flexor.errors import InputError, ModelWarning
from flexor.study import Problem, optimize
from flexor.study.ineffective import ineffective
from flexor.study.sentences import cautions

PLACE = {"proximal.to.at": (0.4, 0.7)}
VARIED = {**PLACE, "exosuit.section.wall": ("1.5 mm", "3 mm")}


def test_an_objective_without_variables_is_refused() -> None:
    """Also of the name of a preset, which is loaded."""
    with pytest.raises(InputError, match=r"depends on none of the variables \(proximal.to.at\)"):
        optimize("pneumatic-finger", PLACE, "minimise mass")
    with pytest.raises(InputError, match="depends on none of the variables"):  # also with errors
        optimize("pneumatic-finger", PLACE, "minimise mass", tolerance={"exosuit.length": "1 mm"})


def test_what_may_differ_elsewhere_is_a_warning() -> None:
    model = flexor.load("pneumatic-finger")
    with pytest.warns(ModelWarning, match='"minimise snaps" is 0 for all of 16 designs'):
        optimize(model, PLACE, "minimise snaps", budget=1)


def test_a_constraint_that_none_keeps_at_first_is_a_warning() -> None:
    """Not if it has to hold at the end only."""
    model, bound = flexor.load("pneumatic-finger"), "bending >= 30 deg"
    aim, wall = "minimise mass", {"exosuit.section.wall": ("1.5 mm", "3 mm")}
    with pytest.warns(ModelWarning, match='0 kPa, where bending is 0 deg: add "at end"'):
        optimize(model, wall, aim, subject_to=[bound], budget=1)
    with warnings.catch_warnings():
        warnings.simplefilter("error", ModelWarning)
        assert optimize(model, wall, aim, subject_to=[f"{bound} at end"], budget=1).best.feasible


def test_a_constraint_far_from_being_kept_is_a_warning() -> None:
    """One that some designs could keep is not, though none of those that are tried does."""
    aim, wall = "minimise mass", {"exosuit.section.wall": ("1.5 mm", "3 mm")}
    said = r"may never hold: centreline-depth is from -\d.* mm to .* mm for 16 designs"
    with pytest.warns(ModelWarning, match=said):
        optimize("pneumatic-finger", wall, aim, subject_to=["centreline-depth <= -2 m"], budget=1)
    tight = "mass <= 10 g"
    with warnings.catch_warnings():
        warnings.simplefilter("error", ModelWarning)
        assert not optimize(
            "pneumatic-finger", wall, aim, subject_to=[tight], budget=1
        ).best.feasible


def test_an_objective_that_depends_on_one_of_two_is_searched() -> None:
    study = optimize("pneumatic-finger", VARIED, "minimise mass", without=["defaults"], budget=3)
    assert study.evaluations == 3
    assert study.best.verdict.ineffective == ("proximal.to.at",)
    said = cautions(study.best)[0]
    assert said.startswith("proximal.to.at has no effect on what is sought and the constraints")


def test_a_variable_that_a_constraint_depends_on_has_an_effect() -> None:
    """Also if the constraint is far from its bound, and slopes at single designs are zero."""
    bounded = ["strap-force <= 100 N"]
    problem = Problem.of("pneumatic-finger", VARIED, "minimise mass", None, subject_to=bounded)
    assert ineffective(problem, problem.parameters.start[None, :]) == ()
