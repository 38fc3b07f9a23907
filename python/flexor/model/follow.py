"""Follow the equilibria of many designs, a chunk of them at a time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from flexor._engine import REGULARITY, STABILITY, STATUS
from flexor.design.geometry import Geometry
from flexor.errors import InputError
from flexor.model.chunks import SIZE, chunks
from flexor.model.events import event_table
from flexor.model.results import Paths
from flexor.model.solver import solver_options, useful_threads
from flexor.model.structure import Structure

Array = NDArray[np.float64]
_EngineArray = Literal[
    "q", "stable", "iterations", "residual", "tolerance", "energy", "pairs", "touching", "tip_force"
]
_ARRAYS: tuple[_EngineArray, ...] = get_args(_EngineArray)
_STATUS: NDArray[np.object_] = np.array(STATUS, dtype=object)
_STABILITY: NDArray[np.object_] = np.array(STABILITY, dtype=object)
_REGULARITY: NDArray[np.object_] = np.array(REGULARITY, dtype=object)
_CONVERGED = STATUS.index("converged")


def follow(
    model: Structure,
    geometry: Geometry | None,
    loads: Array,
    threads: int,
    options: Mapping[str, float],
    gradient: bool = False,
) -> Paths:
    """Follow designs from rest through the same loads.

    Parameters
    ----------
    model
        The model.
    geometry
        Geometry of n designs; None for the model as it is, one path.
    loads : (steps, inputs) array
        Loads [N]. A path starts without load even if its first load is not zero.
    threads
        How many; 0 for one per core. Results do not depend on it.
    options
        Settings of the engine's solver.
    gradient
        Whether to differentiate the last step with respect to the geometry.

    Raises
    ------
    InputError
        If an option is not known or cannot be used.
    """
    settings: dict[str, Any] = {**solver_options(options)}
    threads = useful_threads(threads)
    # The engine starts at the first load, from the reference state; paths start without load.
    lead = int(bool(loads[0].any()))
    steps = np.concatenate([np.zeros((lead, loads.shape[1])), loads])
    indices, values = np.zeros(0, dtype=np.intp), np.zeros((1, 0))
    count = 1 if geometry is None else len(geometry)
    whole: dict[str, Any] = {}
    # Ask for what the results need before the engine does, which would abort the process.
    for size in (count, min(count, SIZE)):
        np.empty((size, len(steps), model.engine.dof + 8))
    for chunk in chunks(count):
        if geometry is not None:
            indices, values = model.geometry_slots(geometry[chunk])
        if gradient:
            settings["gradient"] = indices.astype(np.int64)
        try:
            found = model.engine.path(indices, values, steps, threads, **settings)
        except (TypeError, ValueError) as error:
            raise InputError(f"{str(error).rstrip('.')}.") from None
        arrays: dict[str, NDArray[Any]] = {name: found[name][:, lead:] for name in _ARRAYS}
        codes, events = found["status"][:, lead:], found["events"]
        arrays["status"], arrays["converged"] = _STATUS[codes], codes == _CONVERGED
        arrays["stability"] = _STABILITY[found["stability"][:, lead:]]
        arrays["free"] = _free(found["free"], codes.shape, lead, model)
        arrays["event_table"] = event_table(events, len(codes), lead, model.joint_columns)
        arrays["event_count"] = np.bincount(events["design"], minlength=len(codes))
        arrays["total_iterations"] = arrays["iterations"].sum(axis=1, dtype=np.int64)
        if gradient:
            arrays["gradient"] = found["gradient"]
            arrays["regularity"] = _REGULARITY[found["regularity"]]
        for name, array in arrays.items():
            target = whole.setdefault(name, np.empty((count, *array.shape[1:]), array.dtype))
            target[chunk] = array
    if geometry is not None:
        whole |= {name: getattr(geometry, name) for name in ("length", "radius", "slope")}
    angles = whole["q"][:, :, model.joint_columns]
    return Paths(model=model, loads=loads, joint_angles=angles, **whole)


def _free(
    found: NDArray[np.uint64], shape: tuple[int, ...], lead: int, model: Structure
) -> NDArray[np.object_]:
    """Name, for each design and step, the coordinates of motions that nothing holds."""
    names = np.full(shape, None, dtype=object)
    names.fill(())
    names_of = model.engine.coordinates
    for design, step, coordinate in found.tolist():
        if step >= lead:
            names[design, step - lead] += (names_of[coordinate],)
    return names
