"""Events along a path: ends of branches of equilibria."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import repeat
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexor._engine import EVENTS
from flexor.arrays import Array

if TYPE_CHECKING:
    from flexor._engine import Events


@dataclass(frozen=True, eq=False)
class Event:
    """The end of a branch of equilibria, and the states before and after it."""

    kind: str  # what happened, one of `flexor._engine.EVENTS`
    step: int  # the step of the path during which it happened, or 0 if before it
    force: float  # the load of the first input at that moment
    loads: Array  # (inputs,), the loads of all inputs at that moment
    angles_before: Array  # (joints,), coordinates of the joints [rad; m for translations]
    angles_after: Array  # (joints,), the same afterwards


def event_table(
    found: Events, count: int, lead: int, joints: NDArray[np.intp]
) -> NDArray[np.object_]:
    """Split the engine's events by design: (count,) structured arrays with the fields of `Event`.

    Kinds are codes of `EVENTS`, states those of the ``joints``; ``lead`` steps precede the path.
    """
    inputs = found["load"].shape[1]
    table = np.empty(len(found["design"]), dtype=_fields(len(joints), inputs))
    table["kind"] = found["kind"]
    table["step"] = np.maximum(found["step"].astype(np.int64), lead) - lead
    table["force"] = found["load"][:, 0] if inputs else 0.0
    table["loads"] = found["load"]
    table["before"], table["after"] = found["before"][:, joints], found["after"][:, joints]
    by_design = no_events(count, len(joints), inputs)
    for design in np.unique(found["design"]).tolist():
        by_design[design] = table[found["design"] == design]
    return by_design


def no_events(count: int, joints: int, inputs: int) -> NDArray[np.object_]:
    """Return an empty table for each of ``count`` designs."""
    empty = np.empty(0, dtype=_fields(joints, inputs))
    return np.fromiter(repeat(empty, count), dtype=object, count=count)


def _fields(joints: int, inputs: int) -> np.dtype[Any]:
    fields: list[Any] = [("kind", np.uint8), ("step", np.int64), ("force", np.float64)]
    fields.append(("loads", np.float64, (inputs,)))
    states: list[Any] = [("before", np.float64, (joints,)), ("after", np.float64, (joints,))]
    return np.dtype(fields + states)


def events(table: NDArray[Any]) -> tuple[Event, ...]:
    """Return the events of one design."""
    return tuple(
        Event(EVENTS[kind], int(step), float(force), loads, before, after)
        for kind, step, force, loads, before, after in table
    )


def take_steps(table: NDArray[Any], places: NDArray[np.intp]) -> NDArray[Any]:
    """Keep the events of some steps; ``places`` has the new index of each step, -1 for none."""
    if table.dtype == object:
        return each_design(lambda each: take_steps(each, places), table)
    kept: NDArray[Any] = table[places[table["step"]] >= 0]
    kept["step"] = places[kept["step"]]
    return kept


def each_design(
    function: Callable[[NDArray[Any]], Any], tables: NDArray[np.object_]
) -> NDArray[np.object_]:
    """Apply a function to the events of each design."""
    return np.fromiter(map(function, tables), dtype=object, count=len(tables))
