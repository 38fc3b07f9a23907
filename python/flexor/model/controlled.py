"""Loads of inputs that are controlled by the volume of a cavity or the length of a path."""

from __future__ import annotations

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.structure import Structure


def check_controlled(model: Structure, parameters: Array, loads: Array) -> None:
    """Check that no cavity and no path is asked for that is smaller than nothing.

    Parameters
    ----------
    model
        The model.
    parameters : (P,) array
        Those of one design.
    loads : (s, inputs) array
        Its loads.

    Raises
    ------
    InputError
        If a volume to take out is not in the cavity, or a path is shortened beyond its length.
    """
    rest = np.zeros(model.dof)
    for name in model.controlled:
        index = model.inputs.index(name)
        if name in model.pressures:
            volumes = model.engine.volumes(parameters, rest)
            left, what = volumes[model.pressures.index(name)], "its cavity holds {}"
        else:
            lengths = model.engine.actuator_lengths(parameters, rest)
            left, what = lengths[model.threads.index(name)], "its path is {} long"
        grows = -1.0 if model.file.actuators[name].kind == "cable" else 1.0
        least = grows * (grows * loads[:, index]).min()
        if not grows * least > -left:
            raise InputError(
                f'"{name}" has {model.show_load(least, index=index)}: '
                f"{what.format(model.show_load(left, '.4g', index))}."
            )
