"""Work that pressures do along a path, and what of it reaches the joints of limbs."""

from __future__ import annotations

import copy
import json
from weakref import WeakKeyDictionary

import numpy as np

from flexor import _engine
from flexor.arrays import Array
from flexor.model.results import Paths
from flexor.model.structure import Structure


def has_work(model: Structure) -> bool:
    """Return whether pressures alone drive a model with joints, and nothing dissipates work."""
    driven = {model.driven_by[name] for name in model.pressures}
    whole = bool(driven) and driven == set(model.inputs)
    return whole and bool(model.angular_joints) and not model.frictions and not model.controlled


def efficiency(paths: Paths) -> Array:
    """Return the work on the joints over that of the pressures since the first load, (n, s).

    NaN where the pressures have done none.
    """
    supplied = pressure_work(paths)
    least = 1e-9 * np.nanmax(np.abs(supplied), axis=1, keepdims=True, initial=0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.abs(supplied) > least, joint_work(paths) / supplied, np.nan)


def pressure_work(paths: Paths) -> Array:
    """Return the work of all pressures since the first load [J], (n, s).

    From one load to the next that is the change of elastic energy, exactly; where a snap is between
    them, which dissipates some, the mean pressure times the change of volume.
    """
    model = paths.model
    columns = [model.input_of(name) for name in model.pressures]
    pressure, volume = paths.applied[:, :, columns], paths.volume
    elastic = paths.energy + (pressure * volume).sum(axis=2)
    steps = np.diff(elastic, axis=1)
    mean = 0.5 * (pressure[:, 1:] + pressure[:, :-1])
    through_snaps = (mean * np.diff(volume, axis=1)).sum(axis=2)
    for i, events in enumerate(paths.event_table):
        for step in {int(event["step"]) for event in events if event["step"] > 0}:
            steps[i, step - 1] = through_snaps[i, step - 1]
    return np.concatenate([np.zeros((len(paths), 1)), np.cumsum(steps, axis=1)], axis=1)


def joint_work(paths: Paths) -> Array:
    """Return the work on what resists motion of the joints since the first load [J], (n, s).

    Their stiffness, limits, passive torques and couplings.
    """
    model, without = paths.model, _without_resistance(paths.model)
    kept = [
        (own, there)
        for name, there in without.slots.items()
        if (own := model.engine.slots.get(name)) is not None and not name.endswith(_STIFFNESS)
    ]
    found = np.full(paths.q.shape[:2], np.nan)
    bare = without.parameters.copy()
    for i, parameters in enumerate(paths.parameters):
        for (start, stop), (first, last) in kept:
            bare[first:last] = parameters[start:stop]
        for step in np.flatnonzero(np.isfinite(paths.q[i]).all(axis=1)):
            q, u = paths.q[i, step], paths.applied[i, step]
            found[i, step] = model.engine.energy(parameters, q, u) - without.energy(bare, q, u)
    return np.asarray(found - found[:, :1])


_STIFFNESS = ".joint_stiffness"
_BARE: WeakKeyDictionary[Structure, _engine.Model] = WeakKeyDictionary()


def _without_resistance(model: Structure) -> _engine.Model:
    """Return the model with joints that nothing but the exosuit resists."""
    found = _BARE.get(model)
    if found is None:
        described = copy.deepcopy(model.description)
        for body in described["bodies"]:
            joint = body["joint"]
            joint.pop("lower", None)
            joint.pop("upper", None)
            if "stiffness" in joint:
                joint["stiffness"] = [0.0 for _ in joint["stiffness"]]
        for key in ("joint_torques", "joint_couplings"):
            described.pop(key, None)
        found = _BARE[model] = _engine.Model(json.dumps(described))
    return found
