"""The state in which a path begins: coordinates by name, a state found before, or a file of one."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import PydanticCustomError

from flexor.arrays import Array
from flexor.errors import InputError, unknown
from flexor.model.controlled import changes
from flexor.model.friction import read
from flexor.model.schema import Rod
from flexor.model.schema.strain import GLOBAL
from flexor.model.toml import is_special
from flexor.model.units import ANGLE, LENGTH, Dimension
from flexor.model.validation import describe

if TYPE_CHECKING:
    from flexor.model.structure import Structure

Coordinates = Mapping[str, "str | float | Mapping[str, str | float]"]


@dataclass(frozen=True, eq=False)
class Start:
    """Where a path begins."""

    q: Array  # (dof,): generalized coordinates
    load: Array | None = None  # (inputs,): loads of that state [N]; None for a posture without load
    friction: NDArray[Any] | None = None  # points with friction; None if nothing has slipped


def read_start(given: Any, model: Structure) -> Start:
    """Read where a path begins: coordinates by name, a `State`, a `Path` (its last step) or a file.

    The file holds what ``flexor simulate --json`` prints; the path begins at its last equilibrium.
    """
    if isinstance(given, Mapping):
        return Start(coordinates(given, model))
    if isinstance(given, (str, os.PathLike)):
        return _from_file(FilePath(given), model)
    q, loads = (getattr(given, name, None) for name in ("q", "loads"))
    if not isinstance(q, np.ndarray) or not isinstance(loads, np.ndarray) or q.ndim > 2:
        raise InputError(
            f"start is {describe(given)}: expected a table of coordinates, a State, a Path or "
            "the name of a file."
        )
    if q.ndim == 2:
        given = given[-1]
        q, loads = given.q, given.loads
    start = replace(_checked(q, loads, model, "start"), friction=_slipped(given, model))
    if given.model.controlled.keys() == model.controlled.keys():
        return start
    # Forces where the other model has volumes and lengths, and these where it has forces.
    load = given.applied.copy()
    for name, change in changes(model, given.parameters, q).items():
        load[model.inputs.index(name)] = change
    return replace(start, load=load)


def _slipped(given: Any, model: Structure) -> NDArray[Any] | None:
    """Return the points with friction of a state, if they are those of this model."""
    same = given.model.frictions == model.frictions
    return given.friction if same and given.friction is not None else None


def coordinates(given: Coordinates, model: Structure, path: str = "start") -> Array:
    """Return the generalized coordinates (dof,), zero where they are not given.

    Names are those of a joint's coordinate (``"hand.theta_x"``, or the body's alone where its joint
    has one), of all of a rod's strain (``"rod.bend_y"``, the same along the rod) or of one
    coordinate of it (``"rod.bend_y[3]"``); tables within the table are bodies. Angles and lengths
    are texts with units, or SI numbers; bending and twist are angles between the rod's ends,
    extension and shear plain numbers.
    """
    names = model.engine.coordinates
    units = {joint["name"]: joint["unit"] for joint in model.engine.joints}
    places = {name: [index] for index, name in enumerate(names)}
    for joint in model.engine.joints:
        places.setdefault(joint["body"], []).append(joint["coordinate"])
    for body, table in model.file.bodies.items():
        if not isinstance(table, Rod):
            continue
        for mode, basis in table.strain.modes.items():
            stem = f"{body}.{mode}"
            own = [index for index, name in enumerate(names) if name.startswith(f"{stem}[")]
            # Constant along the rod: the first polynomial; the values, not the slopes; all nodes.
            every = 2 if basis.basis == "hermite" else 1
            places[stem] = own[:1] if basis.basis in GLOBAL else own[::every]
    q = np.zeros(len(names))
    for name, value in _flat(given):
        if name not in places:
            offered = dict.fromkeys([*places, *names])
            raise unknown("coordinate", name, [each for each in offered if "[" not in each])
        if len(places[name]) > 1 and name in model.file.bodies:
            several = ", ".join(f'"{names[index]}"' for index in places[name])
            raise InputError(
                f'{path} has "{name}", whose joint has several coordinates: {several}.'
            )
        unit = units.get(names[places[name][0]], "")
        if not unit and any(f".{mode}" in name for mode in ("bend", "twist")):
            unit = "rad"
        q[places[name]] = _value(value, unit, f"{path}.{name}")
    return q


def _flat(given: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for name, value in given.items():
        if isinstance(value, Mapping):
            yield from ((f"{name}.{inner}", each) for inner, each in value.items())
        else:
            yield str(name), value


def _value(value: Any, unit: str, path: str) -> float:
    if isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise InputError(f"{path} is {number!r}: it must be a finite number.")
        return number
    dimensions: dict[str, Dimension] = {"rad": ANGLE, "m": LENGTH}
    if unit in dimensions:
        try:
            return float(dimensions[unit].parse(value))
        except PydanticCustomError as error:
            raise InputError(f"{path} {error.message()}.") from None
    try:
        number = float(value) if isinstance(value, str) else math.nan
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise InputError(f"{path} is {describe(value)}: a strain is a plain number, such as 0.1.")
    return number


def _from_file(file: FilePath, model: Structure) -> Start:
    if is_special(file):
        raise InputError(f'start is "{file}": it is not a regular file.')
    try:
        found: Any = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f'start is "{file}": {error.strerror or "it cannot be read"}.') from None
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict) or not {"coordinates", "q", "converged"} <= set(found):
        raise InputError(
            f'start is "{file}": it does not hold what "flexor simulate --json" prints.'
        )
    names = model.engine.coordinates
    if found["coordinates"] != names:
        raise InputError(
            f'start is "{file}", whose coordinates are not those of the model "{model.name}".'
        )
    inputs, several = model.inputs, len(model.inputs) > 1
    try:
        step = max(step for step, good in enumerate(found["converged"]) if good is True)
        loads = [found["loads"][name] for name in inputs] if several else [found["force"]]
        load = np.array([float(each[step]) for each in loads[: len(inputs)]])
        q = np.array(found["q"][step], dtype=np.float64)
        points = found["friction"][step] if model.frictions and "friction" in found else []
        friction = read(points) if points else None
    except (ValueError, TypeError, KeyError, IndexError, OverflowError):
        raise InputError(f'start is "{file}": it contains no equilibrium.') from None
    start = _checked(q, load, model, f'start is "{file}", which')
    return replace(start, friction=friction)


def _checked(q: Array, load: Array, model: Structure, what: str) -> Start:
    if q.shape != (len(model.engine.coordinates),) or load.shape != (len(model.inputs),):
        raise InputError(
            f"{what} has {q.size} coordinates and {load.size} loads: the model "
            f'"{model.name}" has {len(model.engine.coordinates)} and {len(model.inputs)}.'
        )
    if not (np.isfinite(q).all() and np.isfinite(load).all()):
        raise InputError(f"{what} has no equilibrium in that step.")
    return Start(q, load)
