"""Paths as labelled arrays of xarray, to be saved as netCDF."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.errors import InputError
from flexor.installing import install_command

if TYPE_CHECKING:
    from xarray import Dataset

    from flexor.model.result_arrays import Results

# Names of the axes of each array of paths after those of designs and steps, and units of what is
# not a plain number; joints that slide are in m.
_AXES = {
    "joint_angles": ("joint",),
    "applied": ("input",),
    "volume": ("pressure",),
    "obstacle_force": ("obstacle",),
    "stretch": ("material", "extreme"),
    "derivatives": ("output", "parameter"),
    "q": ("coordinate",),
    "constraint_values": ("constraint",),
    "objective_values": ("objective",),
}
UNITS = {
    "joint_angles": "rad",
    "tip_force": "N",
    "spring_tension": "N",
    "loop_tension": "N",
    "obstacle_force": "N",
    "energy": "J",
    "max_overlap": "m",
    "max_centreline_depth": "m",
    "max_contact_pressure": "Pa",
    "volume": "m3",
    "rod_length": "m",
}
_NAMES = {"n": "design", "s": "step"}
# Not those of the engine's own, nor tables of events.
_LEFT_OUT = (
    "model",
    "followed",
    "loads",
    "radius",
    "slope",
    "slots",
    "gradient",
    "event_table",
    "free",
)


def require_xarray() -> Any:
    """Return the module xarray; InputError, with the command that installs it, without it."""
    try:
        import xarray
    except ImportError:
        raise InputError(
            f"labelled arrays need the package xarray: {install_command('flexor[xarray]')}."
        ) from None
    return xarray


def results_dataset(results: Results) -> Dataset:
    """Return paths, a path or states as a dataset; see `Results.to_xarray`."""
    data: dict[str, Any] = {}
    for each in fields(results):
        value, axes = getattr(results, each.name), each.metadata["axes"]
        if value is not None and axes and each.name not in _LEFT_OUT:
            add(data, each.name, value, tuple(_NAMES[a] for a in axes if a in results.axes))
    if (model := results.model) is None:
        return require_xarray().Dataset(data)
    coordinates = {"joint": list(model.joints), "input": list(model.inputs)}
    if results.loads.size:
        first = ("step",) if "s" in results.axes else ()
        data["loads"] = ((*first, "input"), results.loads, {"long_name": "loads", "units": "SI"})
    if "stretch" in data:
        coordinates["material"] = list(model.file.materials)
        coordinates["extreme"] = ["least", "greatest"]
    if "volume" in data:
        coordinates["pressure"] = list(model.pressures)
    if "obstacle_force" in data:
        coordinates["obstacle"] = list(model.file.obstacles)
    return require_xarray().Dataset(data, coordinates, {"model": model.name})


def add(data: dict[str, Any], name: str, value: Any, first: tuple[str, ...]) -> None:
    """Add an array with these first dimensions, in a form that netCDF can have."""
    array = np.asarray(value)
    if array.size == 0:
        return
    if array.dtype == object:
        array = array.astype(str)
    if array.dtype == bool:
        array = array.astype(np.int8)
    rest = _AXES.get(name, ())
    if len(first) + len(rest) != array.ndim:
        rest = tuple(f"{name}_{axis}" for axis in range(array.ndim - len(first)))
    attributes = {"long_name": name.replace("_", " ")}
    if name in UNITS:
        attributes["units"] = UNITS[name]
    data[name] = ((*first, *rest), array, attributes)
