"""Evaluate an objective: values where a path is good, a reason where it is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flexor.model.results import Paths
from flexor.model.status import MEANINGS
from flexor.objectives.base import Objective


def evaluate_objective(objective: Objective, paths: Paths) -> Paths:
    """Evaluate an objective for the paths of n designs.

    A path counts only if every one of its load steps converged to a stable equilibrium: each step
    starts from the one before it.

    Parameters
    ----------
    objective : Objective
        What to compute; it sees only the paths that are good.
    paths : Paths
        Paths of n designs.

    Returns
    -------
    Paths
        The same with ``value``, ``shown``, ``objective_values`` and ``reason``.
    """
    value, shown = np.full(len(paths), np.inf), np.full(len(paths), np.nan)
    several = np.full((len(paths), objective.count), np.nan)
    reason = np.full(len(paths), "", dtype=object)
    finite = np.isfinite(paths.joint_angles).all(axis=2) & np.isfinite(paths.tip_force)
    good = paths.converged & paths.stable & finite
    evaluated: NDArray[np.bool_] = np.asarray(good.all(axis=1))
    for i in map(int, np.flatnonzero(~evaluated)):
        step = int(np.argmin(good[i]))
        ended = "" if paths.status is None else str(paths.status[i, step])
        if ended == "invalid-design":
            reason[i] = f"cannot exist: {MEANINGS[ended][0]}"
            continue
        status = ""
        if not paths.converged[i, step]:
            failure = "did not converge"
            status = f" ({ended})" if ended else ""
        elif not paths.stable[i, step]:
            failure = "is unstable"
        else:
            failure = "is not a finite number"
        loads = paths.loads if paths.own_loads is None else paths.own_loads[i]
        reason[i] = f"{failure} at {paths.model.show_loads(loads[step])}{status}"
    if evaluated.any():
        chosen = paths if evaluated.all() else paths[evaluated]
        value[evaluated], shown[evaluated] = objective.value(chosen), objective.shown(chosen)
        several[evaluated] = objective.values(chosen)
    every = np.column_stack((value, several))
    for i in map(int, np.flatnonzero(evaluated & ~np.isfinite(every).all(axis=1))):
        found = every[i][~np.isfinite(every[i])][0]
        reason[i] = f'objective "{objective.name}" gave {found:g}'
        value[i], shown[i], several[i] = np.inf, np.nan, np.nan
    return replace(paths, value=value, shown=shown, objective_values=several, reason=reason)
