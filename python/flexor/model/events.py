"""Events on the way of a path: branches of equilibria that ended."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import repeat
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexor._engine import EVENTS

if TYPE_CHECKING:
    from flexor._engine import Events

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Event:
    """A branch of equilibria that ended on the way, and where the model went.

    Attributes
    ----------
    kind : str
        What happened, one of `flexor._engine.EVENTS`.
    step : int
        The step of the path during which it happened, or 0 if before it.
    force : float
        The force of the first input at that moment [N].
    angles_before, angles_after : (joints,) arrays
        Coordinates of the joints on both sides [rad; m for translations].
    """

    kind: str
    step: int
    force: float
    angles_before: Array
    angles_after: Array


def event_table(
    found: Events, count: int, lead: int, joints: NDArray[np.intp]
) -> NDArray[np.object_]:
    """Split the engine's events by design, and keep of their states the joints.

    Parameters
    ----------
    found
        Events of all designs.
    count
        Number of designs.
    lead
        Number of steps before the first of the path.
    joints : (joints,) array
        Which coordinates belong to joints.

    Returns
    -------
    (count,) array of structured arrays
        With the fields of `Event`, kinds as codes of `flexor._engine.EVENTS`.
    """
    width = (len(joints),)
    table = np.empty(
        len(found["design"]),
        dtype=[
            ("kind", np.uint8),
            ("step", np.int64),
            ("force", np.float64),
            ("before", np.float64, width),
            ("after", np.float64, width),
        ],
    )
    table["kind"] = found["kind"]
    table["step"] = np.maximum(found["step"].astype(np.int64), lead) - lead
    table["force"] = found["load"][:, 0] if found["load"].shape[1] else 0.0
    table["before"], table["after"] = found["before"][:, joints], found["after"][:, joints]
    by_design = np.fromiter(repeat(table[:0], count), dtype=object, count=count)
    for design in np.unique(found["design"]).tolist():
        by_design[design] = table[found["design"] == design]
    return by_design


def events(table: NDArray[Any]) -> tuple[Event, ...]:
    """Return the events of one design."""
    return tuple(
        Event(EVENTS[kind], int(step), float(force), before, after)
        for kind, step, force, before, after in table
    )


def take_steps(table: NDArray[Any], places: NDArray[np.intp]) -> NDArray[Any]:
    """Keep the events of some steps.

    Parameters
    ----------
    table
        Events of one design, or an array of these.
    places : (steps,) array
        Where each step goes; -1 for nowhere.
    """
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
