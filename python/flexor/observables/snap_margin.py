"""How far beyond the loads of a path the next snap is."""

from __future__ import annotations

import numpy as np

from flexor._engine import EVENTS
from flexor.arrays import Array
from flexor.model.follow import follow
from flexor.model.geometry import SlotValues
from flexor.model.results import Paths
from flexor.model.start import Start

# The loads are raised in proportion up to this multiple, in so many steps.
REACH, STEPS = 2.0, 10


def snap_margin(paths: Paths) -> Array:
    """Return by how much the last loads can rise until a snap, as a share of them, (n, s).

    All loads rise in proportion. It is ``REACH - 1`` where nothing snaps up to there, and less
    where a path cannot be followed so far; NaN where it ends before; the same at every load.
    """
    shape = paths.joint_angles.shape[:2]
    margins = np.full(len(paths), np.nan)
    for i in np.flatnonzero((paths.converged & paths.stable).all(axis=1)):
        margins[i] = _margin(paths, int(i))
    return np.broadcast_to(margins[:, None], shape).copy()


def _margin(paths: Paths, design: int) -> float:
    loads = paths.loads if paths.own_loads is None else paths.own_loads[design]
    last, factors = loads[-1], np.linspace(1.0, REACH, STEPS + 1)
    if not last.any():
        return REACH - 1.0
    parameters = paths.parameters[design]
    there = SlotValues(np.arange(len(parameters)), parameters[None])
    start = Start(paths.q[design, -1], last)
    found = follow(paths.model, there, factors[1:, None] * last, 1, {}, start=start)
    good = found.converged[0] & found.stable[0]
    reached = float(factors[len(good) if good.all() else int(np.argmin(good))])
    for event in found.event_table[0]:
        if EVENTS[event["kind"]] == "snap":
            # Events have the load of the first input.
            met = event["force"] / last[0] if last[0] else factors[event["step"]]
            return float(min(met, reached) - 1.0)
    return reached - 1.0
