"""Two ropes that cross, from the force at which they just touch."""

from __future__ import annotations

from typing import Any

import _cosserat_model as rods
import numpy as np
from scipy.optimize import newton

from flexor.model import Model, Path, State


def crossed(lower: Any, upper: Any, gravity: Any, n_elements: int) -> tuple[list[State], float]:
    """Return the equilibria of two ropes that touch in the middle, and the force there [N].

    By symmetry the ropes touch in the middle of both, with a vertical force. It is found such that
    their axes are the sum of the radii apart; contact itself is not searched for. Raises
    RuntimeError where the ropes hang clear of each other, or an equilibrium is not found.
    """
    both = (lower, upper)
    models, states = list[Model](), list[State]()
    for rod, sign in zip(both, (-1.0, 1.0), strict=True):
        model, start = rods.build(rod, gravity, n_elements, pushed=(0.0, 0.0, sign))
        models.append(model)
        states.append(_only(model.equilibrium(np.zeros(1), start=start)))

    def gap(force: float) -> float:
        for i, model in enumerate(models):
            states[i] = _only(model.equilibrium(np.array([force]), start=states[i]))
        low, high = (rods.middle(state)[2] for state in states)
        return float(high - low - lower.radius - upper.radius)

    heavy = [each.material.density * each.radius**2 * rods.shape(each, 1).length for each in both]
    weight = float(np.linalg.norm(gravity) * np.pi * sum(heavy))
    if gap(0.0) > 0.0:
        raise RuntimeError("the ropes hang clear of each other")
    force = float(newton(gap, 0.0, x1=0.1 * weight, tol=1e-9 * weight))
    gap(force)
    return states, force


def _only(path: Path) -> State:
    if not path.converged[0]:
        raise RuntimeError(f"no equilibrium: {path.status[0]}")
    return path[0]
