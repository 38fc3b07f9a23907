"""Follow the equilibria of many designs, a chunk of them at a time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from flexor._engine import REGULARITY, STABILITY, STATUS
from flexor.design.geometry import Geometry
from flexor.errors import InputError
from flexor.model.chunks import SIZE, chunks
from flexor.model.events import event_table
from flexor.model.results import Paths
from flexor.model.solver import solver_options, useful_threads
from flexor.model.start import Start
from flexor.model.structure import Structure

if TYPE_CHECKING:
    from flexor._engine import Events

Array = NDArray[np.float64]
_EngineArray = Literal[
    "q",
    "stable",
    "iterations",
    "residual",
    "tolerance",
    "energy",
    "pairs",
    "touching",
    "tip_force",
    "volume",
    "stretch",
]
_ARRAYS: tuple[_EngineArray, ...] = get_args(_EngineArray)
_STATUS: NDArray[np.object_] = np.array(STATUS, dtype=object)
_STABILITY: NDArray[np.object_] = np.array(STABILITY, dtype=object)
_REGULARITY: NDArray[np.object_] = np.array(REGULARITY, dtype=object)
_CONVERGED, _UNSTABLE = STATUS.index("converged"), STATUS.index("unstable")


def follow(
    model: Structure,
    geometry: Geometry | None,
    loads: Array,
    threads: int,
    options: Mapping[str, float],
    gradient: bool = False,
    start: Start | None = None,
) -> Paths:
    """Follow designs from one state through the same loads.

    Parameters
    ----------
    model
        The model.
    geometry
        Geometry of n designs; None for the model as it is, one path.
    loads : (steps, inputs) array
        Loads [N]. A path begins under the start's load, without load unless it has one, even if
        its first load is another.
    threads
        How many; 0 for one per core. Results do not depend on it.
    options
        Settings of the engine's solver.
    gradient
        Whether to differentiate the last step with respect to the geometry.
    start
        Where the paths begin; the reference state unless given.

    Raises
    ------
    InputError
        If an option is not known or cannot be used.
    """
    settings: dict[str, Any] = {**solver_options(options)}
    threads = useful_threads(threads)
    steps = _from_start(loads, start)
    lead = len(steps) - len(loads)
    if start is not None:
        settings["start"] = start.q
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


def follow_branch(
    model: Structure,
    geometry: Geometry | None,
    loads: Array,
    options: Mapping[str, float],
    start: Start | None = None,
) -> Paths:
    """Follow the branch of one design by arc length, through its limit points.

    Parameters
    ----------
    model, geometry, loads, options, start
        As for `follow`, of one design.

    Returns
    -------
    Paths
        One path, whose steps are the points of the branch with the loads found there.
    """
    settings: dict[str, Any] = {**solver_options(options)}
    parameters = model.parameters.copy()
    shape = {}
    if geometry is not None:
        indices, values = model.geometry_slots(geometry)
        parameters[indices] = values[0]
        shape = {name: getattr(geometry, name) for name in ("length", "radius", "slope")}
    if start is not None:
        settings["start"] = start.q
    steps = _from_start(loads, start)
    try:
        found: dict[str, Any] = dict(model.engine.branch(parameters, steps, **settings))
    except (TypeError, ValueError) as error:
        raise InputError(f"{str(error).rstrip('.')}.") from None
    codes, found_loads = found.pop("status"), found.pop("loads")
    stability = _STABILITY[found.pop("stability")]
    arrays = {name: array[None] for name, array in found.items()}
    none = np.zeros(0, dtype=np.uint32)
    events: Events = {
        "design": none,
        "step": none,
        "kind": none.astype(np.uint8),
        "load": np.zeros((0, loads.shape[1])),
        "before": np.zeros((0, len(model.engine.coordinates))),
        "after": np.zeros((0, len(model.engine.coordinates))),
    }
    return Paths(
        model=model,
        loads=found_loads,
        status=_STATUS[codes][None],
        converged=np.isin(codes, [_CONVERGED, _UNSTABLE])[None],
        stable=(stability == "stable")[None],
        stability=stability[None],
        joint_angles=arrays["q"][:, :, model.joint_columns],
        event_table=event_table(events, 1, 0, model.joint_columns),
        event_count=np.zeros(1, dtype=np.int64),
        total_iterations=arrays["iterations"].sum(axis=1, dtype=np.int64),
        **arrays,
        **shape,
    )


def _from_start(loads: Array, start: Start | None) -> Array:
    """Put the start's load, zero unless it has one, before other loads."""
    first = np.zeros(loads.shape[1]) if start is None or start.load is None else start.load
    return loads if np.array_equal(first, loads[0]) else np.concatenate([first[None], loads])
