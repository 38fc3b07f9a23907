"""Judging a batch: values where the path is good, a reason where it is not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from flexor.objectives.base import Objective
from flexor.objectives.paths import BoolArray, FloatArray, PathArrays, Paths

StatusWord = Callable[[int, int], str]


@dataclass(frozen=True)
class Judgement:
    """Outcome of a batch of n designs.

    Attributes
    ----------
    value : (n,) array
        Value to minimise; never NaN, +inf where the design failed.
    shown : (n,) array
        The objective's quantity for display; NaN where the design failed.
    reason : tuple of n str
        Empty where the design is good, else why it is not, for example
        ``"did not converge at 3 N"``.
    """

    value: FloatArray
    shown: FloatArray
    reason: tuple[str, ...]


def judge(objective: Objective, paths: Paths, status: StatusWord | None = None) -> Judgement:
    """Judge the paths of a batch of designs.

    A path counts only if every one of its load steps converged to a stable equilibrium: each step
    starts from the one before it.

    Parameters
    ----------
    objective : Objective
        What to compute; it sees only the paths that are good.
    paths : Paths
        Paths of n designs.
    status : callable, optional
        From design and step to the engine's word for it, added to the reason.

    Returns
    -------
    Judgement
        Values, quantities and reasons, (n,) each.
    """
    arrays = PathArrays.of(paths)
    n = len(arrays)
    reason = [""] * n
    finite = np.isfinite(arrays.joint_angles).all(axis=2) & np.isfinite(arrays.tip_force)
    good = arrays.converged & arrays.stable & finite
    judged: BoolArray = np.asarray(good.all(axis=1))
    for i in map(int, np.flatnonzero(~judged)):
        step = int(np.argmin(good[i]))
        word = ""
        if not arrays.converged[i, step]:
            said = "did not converge"
            word = f" ({status(i, step)})" if status is not None else ""
        elif not arrays.stable[i, step]:
            said = "is unstable"
        else:
            said = "is not a finite number"
        reason[i] = f"{said} at {arrays.force[step]:g} N{word}"
    value, shown = np.full(n, np.inf), np.full(n, np.nan)
    if judged.any():
        chosen = arrays.take(judged)
        value[judged], shown[judged] = objective.value(chosen), objective.shown(chosen)
    for i in map(int, np.flatnonzero(judged & ~np.isfinite(value))):
        reason[i] = f'objective "{objective.name}" gave {value[i]:g}'
        value[i], shown[i] = np.inf, np.nan
    return Judgement(value, shown, tuple(reason))
