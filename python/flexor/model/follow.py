"""Follow the equilibria of many designs, a chunk of them at a time."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from flexor._engine import REGULARITY, STABILITY, STATUS
from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.chunks import SIZE, chunks
from flexor.model.controlled import check_controlled
from flexor.model.events import event_table, no_events
from flexor.model.geometry import Geometry, SlotValues
from flexor.model.results import Paths
from flexor.model.solver import solver_options, useful_threads
from flexor.model.start import Start
from flexor.model.structure import Structure

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
    "applied",
    "max_overlap",
    "max_contact_pressure",
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
    geometry: Geometry | SlotValues | None,
    loads: Array,
    threads: int,
    options: Mapping[str, float],
    gradient: bool = False,
    start: Start | None = None,
) -> Paths:
    """Follow n designs, or the model as it is, from one state through loads (steps, inputs) [N].

    A path begins under the start's load, zero unless it has one, even if its first load is another.
    With ``gradient`` the last step is differentiated with respect to the geometry.
    """
    settings, steps = _from_start(loads, start, options)
    threads, lead = useful_threads(threads), len(steps) - len(loads)
    indices, values = np.zeros(0, dtype=np.intp), np.zeros((1, 0))
    count = 1 if geometry is None else len(geometry)
    if model.controlled and count == 1:
        check_controlled(model, _parameters(model, geometry), loads)
    whole: dict[str, Any] = {}
    _ask_for_memory(count, len(steps), model.engine.dof, threads)
    for chunk in chunks(count):
        if geometry is not None:
            indices, values = _slots(model, geometry[chunk])
        if gradient:
            settings["gradient"] = indices.astype(np.int64)
        with _input_errors():
            found = model.engine.path(indices, values, steps, threads, **settings)
        arrays: dict[str, NDArray[Any]] = {name: found[name][:, lead:] for name in _ARRAYS}
        codes, events = found["status"][:, lead:], found["events"]
        arrays["status"], arrays["converged"] = _STATUS[codes], codes == _CONVERGED
        arrays["stability"] = _STABILITY[found["stability"][:, lead:]]
        arrays["free"] = _free(found["free"].tolist(), codes.shape, lead, model)
        arrays["event_table"] = event_table(events, len(codes), lead, model.joint_columns)
        arrays["event_count"] = np.bincount(events["design"], minlength=len(codes))
        arrays["total_iterations"] = arrays["iterations"].sum(axis=1, dtype=np.int64)
        if gradient:
            arrays["gradient"] = found["gradient"]
            arrays["regularity"] = _REGULARITY[found["regularity"]]
        for name, array in arrays.items():
            target = whole.setdefault(name, np.empty((count, *array.shape[1:]), array.dtype))
            target[chunk] = array
    angles = whole["q"][:, :, model.joint_columns]
    return Paths(model=model, loads=loads, joint_angles=angles, **whole, **_arrays(model, geometry))


def _ask_for_memory(count: int, steps: int, dof: int, threads: int) -> None:
    """Raise MemoryError if the results do not fit, where the engine would abort the process."""
    workers = min(count, threads or os.cpu_count() or 1)
    chunk = min(count, SIZE)
    # The results of all, those of a chunk from the engine and in Python, and the tangents.
    shapes = [(each, steps, dof + 8) for each in (count, chunk, chunk)] + [(3, workers, dof * dof)]
    _ = [np.empty(shape) for shape in shapes]


def _free(
    found: Iterable[Iterable[int]], shape: tuple[int, ...], lead: int, model: Structure
) -> NDArray[np.object_]:
    """Name, for each design and step, the coordinates of motions that nothing holds."""
    names = np.empty(shape, dtype=object)
    names.fill(())
    coordinates = model.engine.coordinates
    for design, step, coordinate in found:
        if step >= lead:
            names[design, step - lead] += (coordinates[coordinate],)
    return names


def follow_branch(
    model: Structure,
    geometry: Geometry | SlotValues | None,
    loads: Array,
    options: Mapping[str, float],
    start: Start | None = None,
) -> Paths:
    """Follow the branch of one design by arc length, through its limit points.

    The steps of the path are the points of the branch, with the loads found there.
    """
    for name in model.controlled:
        raise InputError(
            f'follow is "arc-length", which needs a load to find, but that of "{name}" is found '
            "already: leave it out."
        )
    settings, steps = _from_start(loads, start, options)
    with _input_errors():
        branch = model.engine.branch(_parameters(model, geometry), steps, **settings)
    found: dict[str, Any] = dict(branch)
    codes, found_loads = found.pop("status"), found.pop("loads")
    stability = _STABILITY[found.pop("stability")]
    free = [(0, *each) for each in found.pop("free").tolist()]
    arrays = {name: array[None] for name, array in found.items()}
    return Paths(
        model=model,
        loads=found_loads,
        applied=found_loads[None],
        status=_STATUS[codes][None],
        converged=np.isin(codes, [_CONVERGED, _UNSTABLE])[None],
        stable=(stability == "stable")[None],
        stability=stability[None],
        free=_free(free, (1, len(codes)), 0, model),
        joint_angles=arrays["q"][:, :, model.joint_columns],
        event_table=no_events(1, len(model.joints)),
        event_count=np.zeros(1, dtype=np.int64),
        total_iterations=arrays["iterations"].sum(axis=1, dtype=np.int64),
        **arrays,
        **_arrays(model, geometry),
    )


def _slots(model: Structure, design: Geometry | SlotValues) -> tuple[NDArray[np.intp], Array]:
    """Return which of the engine's parameters designs change, and to what."""
    if isinstance(design, SlotValues):
        return design.indices, design.values
    return model.geometry_slots(design)


def _parameters(model: Structure, geometry: Geometry | SlotValues | None) -> Array:
    """Return the engine's parameters of one design, (P,)."""
    parameters = model.parameters.copy()
    if geometry is not None:
        indices, values = _slots(model, geometry)
        parameters[indices] = values[0]
    return parameters


def _from_start(
    loads: Array, start: Start | None, options: Mapping[str, float]
) -> tuple[dict[str, Any], Array]:
    """Return the engine's settings, and the loads from that of the start on."""
    settings: dict[str, Any] = {**solver_options(options)}
    if start is not None:
        settings["start"] = start.q
    first = np.zeros(loads.shape[1]) if start is None or start.load is None else start.load
    if not np.array_equal(first, loads[0]):
        loads = np.concatenate([first[None], loads])
    return settings, loads


def _arrays(model: Structure, geometry: Geometry | SlotValues | None) -> dict[str, Any]:
    if geometry is None:
        return {}
    if isinstance(geometry, SlotValues):
        slots = np.repeat(model.parameters[None, :], len(geometry), axis=0)
        slots[:, geometry.indices] = geometry.values
        return {"slots": slots}
    return {"rod_length": geometry.length, "radius": geometry.radius, "slope": geometry.slope}


@contextmanager
def _input_errors() -> Iterator[None]:
    """Raise errors of the engine as `InputError`."""
    try:
        yield
    except (TypeError, ValueError) as error:
        raise InputError(f"{str(error).rstrip('.')}.") from None
