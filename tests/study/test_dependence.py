"""An objective that no variable has an effect on is said before a search."""

from __future__ import annotations

import pytest

import flexor
from flexor.errors import InputError, ModelWarning
from flexor.study import optimize

PLACE = {"proximal.to.at": (0.4, 0.7)}


def test_an_objective_without_variables_is_refused() -> None:
    """Also of the name of a preset, which is loaded."""
    with pytest.raises(InputError, match=r"depends on none of the variables \(proximal.to.at\)"):
        optimize("pneumatic-finger", PLACE, "minimise mass")


def test_what_may_differ_elsewhere_is_a_warning() -> None:
    model = flexor.load("pneumatic-finger")
    with pytest.warns(ModelWarning, match='"minimise snaps" is 0 for all of 16 designs'):
        optimize(model, PLACE, "minimise snaps", budget=1)


def test_an_objective_that_depends_on_one_of_two_is_searched() -> None:
    varied = {**PLACE, "exosuit.section.wall": ("1.5 mm", "3 mm")}
    study = optimize("pneumatic-finger", varied, "minimise mass", budget=3)
    assert study.evaluations == 3
