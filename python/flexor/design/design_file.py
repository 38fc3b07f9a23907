"""The model file of one design."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexor.design.fields import keys_of, replaced
from flexor.design.parameter_set import ParameterSet
from flexor.design.variables import Variables
from flexor.model.reading import check
from flexor.model.schema import ModelFile

if TYPE_CHECKING:
    from flexor.arrays import Array
    from flexor.model.structure import Structure

# Samples of a profile that is not linear: what lies between is a monotone cubic.
SAMPLES = 101


def drawn_file(chosen: ParameterSet, p: Array, model: Structure) -> ModelFile:
    """Return a model file with the sections and straps of one design, which are not checked.

    Parameters
    ----------
    chosen
        The parameter set; one that sets lengths and radii changes no section.
    p : (k,) array
        The design, SI.
    model
        The model.
    """
    if not isinstance(chosen, Variables):
        return model.file
    keys = [keys_of(label, model.file) for label in chosen.labels]
    return replaced(model.file, dict(zip(keys, np.asarray(p).tolist(), strict=True)))


def saved_file(chosen: ParameterSet, p: Array, model: Structure) -> ModelFile:
    """Return the model file of one design, checked.

    Parameters
    ----------
    chosen
        The parameter set.
    p : (k,) array
        The design, SI.
    model
        The model.

    Raises
    ------
    InputError
        If the design is no valid model.
    """
    changes = chosen.changes(p) if isinstance(chosen, Variables) else _profile(chosen, p, model)
    return check(model.file.to_document(), changes=changes, source=model.name)


def _profile(chosen: ParameterSet, p: Array, model: Structure) -> dict[str, object]:
    """Return length and radius of a profile as changes of the model file."""
    name = model.design.rod
    geometry = chosen.geometry(p, np.linspace(0.0, 1.0, SAMPLES))
    radius = geometry.radius[0]
    line = np.linspace(radius[0], radius[-1], SAMPLES)
    linear = bool(np.abs(radius - line).max() <= 1e-12 * radius.max())
    kept = [radius[0], radius[-1]] if linear else radius
    return {
        f"bodies.{name}.length": f"{float(geometry.length[0])!r} m",
        f"bodies.{name}.radius": [f"{float(value)!r} m" for value in kept],
    }
