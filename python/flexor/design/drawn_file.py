"""The model file of one design, for drawing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexor.design.fields import replaced
from flexor.design.parameter_set import ParameterSet
from flexor.design.variables import Variables
from flexor.model.schema import ModelFile

if TYPE_CHECKING:
    from flexor.arrays import Array
    from flexor.model.structure import Structure


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
    values = dict(zip(chosen.fields, chosen.field_values(np.asarray(p))[0].tolist(), strict=True))
    # Loads change nothing of what is drawn; their fields may be lists.
    sizes = {keys: values[label] for label, keys in chosen.keys(model).items()}
    return replaced(model.file, sizes)
