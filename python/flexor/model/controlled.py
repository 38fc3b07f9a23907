"""Loads of inputs that are controlled by the volume of a cavity or the length of a path."""

from __future__ import annotations

import numpy as np

from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.structure import Structure

# Share of a cavity's volume that strains of about one have to change, for a syringe to move them.
LEAST_CHANGE = 1e-9


def check_controlled(model: Structure, parameters: Array, loads: Array) -> None:
    """Check that no cavity and no path is asked for that cannot be.

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
        If no strain changes the volume of a cavity, a volume to take out is not in it, or a path is
        shortened beyond its length.
    """
    rest = _sizes(model, parameters, np.zeros(model.dof))
    # A volume is linear in the coordinates, so that one state without symmetry tells.
    strained = _sizes(model, parameters, np.sin(1.0 + np.arange(model.dof)))
    for name, left in rest.items():
        if name in model.pressures and abs(strained[name] - left) <= LEAST_CHANGE * left:
            rod = model.file.actuators[name].rod
            raise InputError(
                f'"{name}" is controlled by its volume, which no strain of "{rod}" changes: let it '
                "stretch (extend_x), or control the pressure."
            )
        index = model.inputs.index(name)
        grows = _sign(model, name)
        least = grows * (grows * loads[:, index]).min()
        if not grows * least > -left:
            shown = model.show_load(left, ".4g", index)
            what = f"cavity holds {shown}" if name in model.pressures else f"path is {shown} long"
            asked = model.show_load(least, index=index)
            raise InputError(f'"{name}" has {asked}: its {what}.')


def changes(model: Structure, parameters: Array, q: Array) -> dict[str, float]:
    """Return the load of each controlled input in a state: its change from the reference state.

    Parameters
    ----------
    model
        The model.
    parameters : (P,) array
        Those of one design.
    q : (dof,) array
        Generalized coordinates.

    Returns
    -------
    dict of float
        By input [m or m³].
    """
    rest, now = (_sizes(model, parameters, at) for at in (np.zeros(model.dof), q))
    return {name: _sign(model, name) * (now[name] - rest[name]) for name in model.controlled}


def _sizes(model: Structure, parameters: Array, q: Array) -> dict[str, float]:
    """Return the volume of the cavity or the length of the path of each controlled input."""
    volumes = model.engine.volumes(parameters, q)
    lengths = model.engine.actuator_lengths(parameters, q)
    sizes = dict(zip((*model.pressures, *model.threads), (*volumes, *lengths), strict=True))
    return {name: float(sizes[name]) for name in model.controlled}


def _sign(model: Structure, name: str) -> float:
    """Return -1 for a cable, whose loads shorten it."""
    return -1.0 if model.file.actuators[name].kind == "cable" else 1.0
