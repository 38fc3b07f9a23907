"""Critical twist of a straight rod under tension, from the stability of its equilibria."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import _cosserat_model as rods
import numpy as np


def critical_twist(rod: Any, n_elements: int) -> float:
    """Return the rotation of its driven end at which the straight rod becomes unstable [rad].

    The branch of straight states is followed by arc length, stable or not. The rotation is that
    beyond which the tangent is not positive definite, found by bisection up to a fifth more than
    the largest of the rod's motion; NaN if the rod is still stable there.
    """
    straight = replace(rod, centerline=(rod.centerline[0], rod.centerline[-1]))
    model, _ = rods.build(straight, (0.0, 0.0, 0.0), n_elements)

    def stable(turn: float) -> bool:
        path = model.equilibrium(np.array([0.0, turn]), follow="arc-length")
        if not path.converged[-1]:
            raise RuntimeError(f"no straight state at {turn} rad: {path.status[-1]}")
        return bool(path.stable[-1])

    low, high = 0.0, 1.2 * rods.driven(rod.end_motion, np.array(rod.end_motion.times)).max()
    if stable(high):
        return float("nan")
    while high - low > 1e-6 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return float(0.5 * (low + high))
