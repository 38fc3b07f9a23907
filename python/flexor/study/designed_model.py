"""The model with a design in place of its own exosuit, to be written as a model file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexor.design import Variables
from flexor.errors import InputError
from flexor.model.loading import changed_model
from flexor.study.problem import FloatArray, Problem

if TYPE_CHECKING:
    from flexor.model import Model

# Samples of a radius that is not linear, from base to tip.
_SAMPLES = 101


def designed_model(problem: Problem, design: FloatArray) -> Model:
    """Return the model of one design (k,), SI.

    Fields take their values. Of a parameter set the rod gets the length and the radius, which is
    written as base and tip if it is linear and as equally spaced samples otherwise.
    """
    chosen, model = problem.parameters, problem.model
    if isinstance(chosen, Variables):
        return changed_model(model, chosen.changes(design))
    space = model.file.design
    if space is None or space.rod is None:
        raise InputError(f"{model.name}: design.rod does not say whose length and radius it is.")
    at = np.linspace(0.0, 1.0, _SAMPLES)
    found = chosen.geometry(design[None, :], at)
    radius = found.radius[0]
    straight = np.allclose(radius, np.linspace(radius[0], radius[-1], _SAMPLES), rtol=1e-12)
    ends = [f"{value!r} m" for value in radius.tolist()]
    shape = {"base": ends[0], "tip": ends[-1]} if straight else ends
    name = f"bodies.{space.rod}"
    changes = {f"{name}.length": f"{float(found.length[0])!r} m", f"{name}.radius": shape}
    return changed_model(model, changes)
