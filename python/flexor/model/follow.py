"""Follow the equilibria of many designs, a part of them at a time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from flexor._engine import REGULARITY
from flexor.errors import InputError
from flexor.model.batch import Batch
from flexor.model.geometry import Rows
from flexor.model.solver import solver_options

if TYPE_CHECKING:
    from flexor._engine import Events
    from flexor.model.model import Model

Array = NDArray[np.float64]

# What the engine needs of each design (all its parameters that vary) is made for so many at a time:
# enough to keep every core busy, few enough that 100,000 designs fit into a laptop.
PART = 1024
_Array = Literal[
    "q",
    "status",
    "stable",
    "iterations",
    "residual",
    "energy",
    "pairs",
    "touching",
    "tip_force",
]
_REGULARITY: NDArray[np.object_] = np.array(REGULARITY, dtype=object)
_ARRAYS: tuple[_Array, ...] = get_args(_Array)


def follow(
    model: Model,
    geometry: Rows | None,
    loads: Array,
    threads: int,
    options: Mapping[str, float],
    gradient: bool = False,
) -> Batch:
    """Follow designs from rest through the same loads.

    Parameters
    ----------
    model
        The model.
    geometry
        Geometry of n designs; None for the model as it is, a batch of one.
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
    settings = solver_options(options)
    # The engine starts at the first load, from the reference state; paths start without load.
    lead = int(bool(loads[0].any()))
    steps = np.concatenate([np.zeros((lead, loads.shape[1])), loads])
    count = 1 if geometry is None else len(geometry)
    found: dict[str, NDArray[Any]] = {}
    events = []
    slopes: list[Array] = []
    codes: list[NDArray[np.uint8]] = []
    for first in range(0, max(count, 1), PART):
        if geometry is None:
            indices, values = np.zeros(0, dtype=np.intp), np.zeros((1, 0))
        else:
            indices, values = model.geometry_slots(geometry[first : first + PART])
        try:
            wanted: Any = {"gradient": indices.astype(np.int64)} if gradient else {}
            part = model.engine.path(indices, values, steps, threads, **wanted, **settings)
        except (TypeError, ValueError) as error:
            raise InputError(f"{str(error).rstrip('.')}.") from None
        events.append(_events(part["events"], first, lead, model.joint_columns))
        for name in _ARRAYS:
            array = part[name][:, lead:]
            whole = found.setdefault(name, np.empty((count, *array.shape[1:]), array.dtype))
            whole[first : first + PART] = array
        if gradient:
            slopes.append(part["gradient"])
            codes.append(part["regularity"])
    return Batch(
        model=model,
        loads=loads,
        geometry=geometry,
        events=_joined(events),
        gradient=np.concatenate(slopes) if gradient else None,
        regularity=_REGULARITY[np.concatenate(codes)] if gradient else None,
        **found,
    )


def _events(found: Events, first: int, lead: int, joints: NDArray[np.intp]) -> Events:
    """Count designs through all parts, and keep of the states the joints."""
    return {
        "design": found["design"] + first,
        "step": np.maximum(found["step"], lead) - lead,
        "load": found["load"],
        "kind": found["kind"],
        "before": found["before"][:, joints],
        "after": found["after"][:, joints],
    }


def _joined(parts: list[Events]) -> Events:
    return {
        "design": np.concatenate([part["design"] for part in parts]),
        "step": np.concatenate([part["step"] for part in parts]),
        "load": np.concatenate([part["load"] for part in parts]),
        "kind": np.concatenate([part["kind"] for part in parts]),
        "before": np.concatenate([part["before"] for part in parts]),
        "after": np.concatenate([part["after"] for part in parts]),
    }
