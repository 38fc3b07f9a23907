"""Follow the equilibria of many designs, a chunk of them at a time."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor._engine import STABILITY, STATUS
from flexor.arrays import Array
from flexor.errors import InputError
from flexor.model.chunks import SIZE, chunks
from flexor.model.controlled import check_controlled
from flexor.model.derivatives import differentiate, last_step
from flexor.model.engine_errors import engine_errors
from flexor.model.events import event_table
from flexor.model.followed import Followed
from flexor.model.friction import friction_table, slips
from flexor.model.geometry import Geometry, SlotValues
from flexor.model.result_arrays import joinings
from flexor.model.results import Paths
from flexor.model.separate import Separate
from flexor.model.solver import solver_options, useful_threads
from flexor.model.start import Start
from flexor.model.structure import Structure

_PER_STEP = tuple(joinings())
_STATUS: NDArray[np.object_] = np.array(STATUS, dtype=object)
_STABILITY: NDArray[np.object_] = np.array(STABILITY, dtype=object)
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

    The loads are those of all designs, or those of each, (n, steps, inputs).

    A path begins under the start's load, zero unless it has one, even if its first load is another.
    With ``gradient`` the last step is differentiated with respect to the geometry.
    """
    followed = _from_start(loads, start, options)
    settings, steps = followed.settings, followed.loads(loads)
    threads, lead = useful_threads(threads), steps.shape[-2] - loads.shape[-2]
    indices, values = np.zeros(0, dtype=np.intp), np.zeros((1, 0))
    count = 1 if geometry is None else len(geometry)
    if model.controlled and count == 1:
        check_controlled(model, _parameters(model, geometry), loads.reshape(-1, loads.shape[-1]))
    if steps.ndim == 3 and len(steps) != count:
        raise InputError(f"loads of {len(steps)} designs are given, but there are {count}.")
    whole: dict[str, Any] = {}
    _check_memory(count, steps.shape[-2], model.engine.dof, threads)
    for chunk in chunks(count):
        if geometry is not None:
            indices, values = _slots(model, geometry[chunk])
        own = steps if steps.ndim == 2 else steps[chunk].reshape(-1, steps.shape[-1])
        listed = steps.shape[-2]
        found = _path(model, indices, values, own, threads, steps=listed, **settings)
        arrays = _arrays(model, found, lead)
        arrays["converged"] = found["status"][:, lead:] == _CONVERGED
        for name, array in arrays.items():
            target = whole.setdefault(name, np.empty((count, *array.shape[1:]), array.dtype))
            target[chunk] = array
    own_loads: Any = loads if loads.ndim == 3 else None
    loads = loads if own_loads is None else own_loads[0]
    paths = Paths(
        model=model,
        followed=followed,
        loads=loads,
        own_loads=own_loads,
        **whole,
        **_geometry(model, geometry),
    )
    if not gradient:
        return paths
    slopes = differentiate(paths, last_step(paths), indices, threads)
    return replace(paths, gradient=slopes.by_slots, regularity=slopes.regularity[:, -1])


def _arrays(model: Structure, found: Mapping[str, Any], lead: int) -> dict[str, NDArray[Any]]:
    """Return the arrays of `Paths` from those of the engine, without the first ``lead`` steps."""
    if lead:
        _tell_first(found, lead)
    arrays: dict[str, NDArray[Any]] = {name: found[name][:, lead:] for name in _PER_STEP}
    codes, events = found["status"][:, lead:], found["events"]
    arrays["status"] = _STATUS[codes]
    arrays["stability"] = _STABILITY[found["stability"][:, lead:]]
    arrays["stable"] = (codes == _CONVERGED) & (arrays["stability"] == "stable")
    arrays["joint_angles"] = arrays["q"][:, :, model.joint_columns]
    if model.frictions:
        arrays["friction"] = friction_table(found["friction"], codes.shape, lead)
    arrays["free"] = _free(found["free"].tolist(), codes.shape, lead, model)
    arrays["event_table"] = event_table(events, len(codes), lead, model.joint_columns)
    arrays["event_count"] = np.bincount(events["design"], minlength=len(codes))
    arrays["total_iterations"] = arrays["iterations"].sum(axis=1, dtype=np.int64)
    return arrays


def _tell_first(found: Mapping[str, Any], lead: int) -> None:
    """Let the first listed load tell why a path ended before it."""
    failed = np.flatnonzero(found["status"][:, lead] == STATUS.index("not-reached"))
    for name in (*_PER_STEP, "status", "stability"):
        found[name][failed, lead] = found[name][failed, lead - 1]


def _check_memory(count: int, steps: int, dof: int, threads: int) -> None:
    """Raise MemoryError if the results do not fit, where the engine would abort the process."""
    workers = min(count, threads or os.cpu_count() or 1)
    chunk = min(count, SIZE)
    # The results of all, those of a chunk from the engine and in Python, and the tangents.
    shapes = [(each, steps, dof + 8) for each in (count, chunk, chunk)] + [(3, workers, dof * dof)]
    _ = [np.empty(shape) for shape in shapes]


def _free(
    found: Iterable[Iterable[int]], shape: tuple[int, ...], lead: int, model: Structure
) -> NDArray[np.object_]:
    """Name the coordinates of free motions, for each design and step."""
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
    if model.frictions:
        raise InputError(
            f'follow is "arc-length", but "{model.frictions[0]}" has friction, which depends on '
            "the order of the loads: leave it out."
        )
    followed = _from_start(loads, start, options)
    with engine_errors():
        branch = model.engine.branch(
            _parameters(model, geometry), followed.loads(loads), **followed.settings
        )
    reached = np.isin(branch["status"], [_CONVERGED, _UNSTABLE])
    arrays: dict[str, Any] = {**_arrays(model, branch, 0), "converged": reached}
    return Paths(model=model, loads=branch["loads"], **arrays, **_geometry(model, geometry))


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


def _from_start(loads: Array, start: Start | None, options: Mapping[str, float]) -> Followed:
    """Return the engine's settings, and the load of the start if paths do not begin at theirs."""
    settings: dict[str, Any] = {**solver_options(options)}
    if start is not None:
        settings["start"] = start.q
        if start.friction is not None and len(start.friction):
            settings["slips"] = slips(start.friction)
    first = np.zeros(loads.shape[-1]) if start is None or start.load is None else start.load
    begins = bool((loads[..., 0, :] == first).all())
    return Followed(settings, loads.shape[-2], None if begins else first)


def _geometry(model: Structure, geometry: Geometry | SlotValues | None) -> dict[str, Any]:
    if geometry is None:
        return {}
    if isinstance(geometry, SlotValues):
        slots = np.repeat(model.parameters[None, :], len(geometry), axis=0)
        slots[:, geometry.indices] = geometry.values
        return {"slots": slots}
    return {"rod_length": geometry.length, "radius": geometry.radius, "slope": geometry.slope}


def _path(model: Structure, *arguments: Any, **settings: Any) -> Mapping[str, Any]:
    """Return the engine's arrays of one chunk of designs; see `flexor._engine.Model.path`."""
    followed = model.followed
    if isinstance(followed, Separate):
        return followed.path(*arguments, **settings)
    with engine_errors():
        return followed.path(*arguments, **settings)
